//! The objective of a whole-object fit and its gradient by one adjoint solve per load.

use crate::error::{Error, Result};
use crate::model::{Network, Support};
use crate::solve::{Factor, System};
use crate::springs::Measure;
use crate::stiffness::gather;

/// A load and how the object moves under it.
#[derive(Debug, Clone)]
pub struct Target {
    pub name: String,
    /// `[points · dimension]`, N.
    pub forces: Vec<f64>,
    /// Of the finite elements, or measured; `[points · dimension]`, m.
    pub displacement: Vec<f64>,
    pub weight: f64,
}

/// A network with springs that start at rest, held by one support, with the constants as unknowns.
#[derive(Debug)]
pub struct Problem<'a> {
    network: Network,
    points: &'a [f64],
    support: &'a Support,
    /// The degrees of freedom of each spring and `g_s` there.
    gradients: Vec<(Vec<usize>, Vec<f64>)>,
    /// `ln k_s⁰`.
    start: Vec<f64>,
    /// ρ.
    pub regularization: f64,
}

/// The objective at one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    pub value: f64,
    /// By every `ln k_s`.
    pub gradient: Vec<f64>,
    /// `‖u_l − u_l^FEM‖/‖u_l^FEM‖` of each load.
    pub errors: Vec<f64>,
}

/// Constants that are not positive start at this share of the median.
const LEAST: f64 = 0.01;

impl<'a> Problem<'a> {
    /// # Errors
    /// A spring has a law of its own or pulls at rest, the network has no springs, or the support prescribes displacements
    /// other than zero.
    pub fn new(network: &Network, points: &'a [f64], support: &'a Support, regularization: f64) -> Result<Problem<'a>> {
        let d = network.dimension;
        if network.is_empty() {
            return Err(Error::expected("springs", "a network with springs", "none"));
        }
        if support.prescribed.iter().flatten().any(|u| *u != 0.0) {
            return Err(Error::expected("fix", "points that are held at rest", "a prescribed displacement"));
        }
        let mut network = network.clone();
        let mut gradients = Vec::new();
        let dofs = |points: &[usize]| points.iter().flat_map(|&p| p * d..(p + 1) * d).collect::<Vec<usize>>();
        let mut add = |measure: &Measure, of: &[usize]| {
            let mut x = vec![0.0; of.len() * d];
            gather(points, d, of, &mut x);
            gradients.push((dofs(of), measure.gradient(&x, d)));
        };
        network.lengths.iter().for_each(|spring| add(&Measure::Length, &spring.points));
        for spring in &network.others {
            if spring.law.is_some() {
                return Err(Error::expected("force", "linear springs", "springs with a law of force"));
            }
            add(&spring.measure, &spring.points);
        }
        let least = |constants: &[f64]| {
            let mut positive: Vec<f64> = constants.iter().copied().filter(|k| *k > 0.0).collect();
            positive.sort_by(f64::total_cmp);
            positive.get(positive.len() / 2).map(|median| LEAST * median)
        };
        let lengths: Vec<f64> = network.lengths.iter().map(|s| s.constant).collect();
        let others: Vec<f64> = network.others.iter().map(|s| s.constant).collect();
        let none = || Error::expected("springs", "a network with a constant above zero", "none");
        let floor = least(&lengths).or(least(&others)).ok_or_else(none)?;
        // Springs of another unit have another median.
        let floor_of_others = least(&others).unwrap_or(floor);
        let start = lengths.iter().map(|k| k.max(floor)).chain(others.iter().map(|k| k.max(floor_of_others)));
        let start: Vec<f64> = start.map(f64::ln).collect();
        set(&mut network, &start);
        Ok(Problem { network, points, support, gradients, start, regularization })
    }

    /// `ln k_s⁰`, `[springs]`.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// The network with these constants.
    pub fn network(&self, logarithms: &[f64]) -> Network {
        let mut network = self.network.clone();
        set(&mut network, logarithms);
        network
    }

    /// `∂J/∂ln k_s = −k_s Σ_l (g_s·λ_l)(g_s·u_l) + 2ρ (θ_s − θ_s⁰)/m`, `K λ_l = ∂J/∂u_l`. `None` where K is not positive definite.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn evaluate(&self, logarithms: &[f64], targets: &[Target]) -> Result<Option<Evaluation>> {
        let network = self.network(logarithms);
        let system = System::new(&network.stiffness(self.points), self.support)?;
        let Some(factor) = system.factorize().filter(Factor::is_positive_definite) else { return Ok(None) };
        let springs = logarithms.len() as f64;
        let away: Vec<f64> = logarithms.iter().zip(&self.start).map(|(a, b)| a - b).collect();
        let mut value = self.regularization * away.iter().map(|d| d * d).sum::<f64>() / springs;
        let mut gradient: Vec<f64> = away.iter().map(|d| 2.0 * self.regularization * d / springs).collect();
        let mut errors = Vec::new();
        for target in targets {
            let (u, _) = system.solve(&factor, &target.forces);
            let size: f64 = target.displacement.iter().map(|u| u * u).sum();
            let lack: Vec<f64> = u.iter().zip(&target.displacement).map(|(u, v)| u - v).collect();
            let square = lack.iter().map(|l| l * l).sum::<f64>() / size;
            value += target.weight * square;
            errors.push(square.sqrt());
            let pull: Vec<f64> = lack.iter().map(|l| 2.0 * target.weight * l / size).collect();
            let (adjoint, _) = system.solve(&factor, &pull);
            for ((dofs, g), (slope, theta)) in self.gradients.iter().zip(gradient.iter_mut().zip(logarithms)) {
                let along = |v: &[f64]| dofs.iter().zip(g).map(|(&i, g)| v[i] * g).sum::<f64>();
                *slope -= theta.exp() * along(&adjoint) * along(&u);
            }
        }
        Ok(Some(Evaluation { value, gradient, errors }))
    }

    /// The displacements under some forces; `None` where K is not positive definite.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn displacements(&self, logarithms: &[f64], forces: &[&[f64]]) -> Result<Option<Vec<Vec<f64>>>> {
        let system = System::new(&self.network(logarithms).stiffness(self.points), self.support)?;
        let Some(factor) = system.factorize().filter(Factor::is_positive_definite) else { return Ok(None) };
        Ok(Some(forces.iter().map(|f| system.solve(&factor, f).0).collect()))
    }
}

fn set(network: &mut Network, logarithms: &[f64]) {
    let (lengths, others) = logarithms.split_at(network.lengths.len());
    network.lengths.iter_mut().zip(lengths).for_each(|(s, theta)| s.constant = theta.exp());
    network.others.iter_mut().zip(others).for_each(|(s, theta)| s.constant = theta.exp());
}
