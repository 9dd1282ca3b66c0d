//! Damping: forces that oppose velocities.
//!
//! Theory: page *Dynamics* of the book.

use crate::error::{Error, Result};
use crate::model::{Entries, Network, Support};
use crate::springs::Measure;
use crate::stiffness::gathered;
use faer::sparse::Triplet;

/// The damping matrix `C = α M + β K₀ + Σ_s c_s ∇c_s ∇c_sᵀ`, with K₀ the tangent at rest.
#[derive(Debug, Clone, Default)]
pub struct Damping {
    /// Rayleigh's α, in 1/s. A mode of circular frequency ω is damped by the ratio `ζ = (α/ω + β ω)/2`.
    pub mass: f64,
    /// Rayleigh's β, in s.
    pub stiffness: f64,
    /// Dampers parallel to the springs, if there are any.
    pub dampers: Option<Dampers>,
}

impl Damping {
    /// Whether nothing opposes velocities.
    pub fn is_none(&self) -> bool {
        self.mass == 0.0 && self.stiffness == 0.0 && self.dampers.is_none()
    }

    pub(super) fn check(&self, points: usize) -> Result<()> {
        for (key, value) in [("damping.mass", self.mass), ("damping.stiffness", self.stiffness)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::expected(key, "a number that is not negative", value));
            }
        }
        let of = self.dampers.as_ref().map_or(points, |dampers| dampers.points);
        match of == points {
            true => Ok(()),
            false => Err(Error::expected("damping.dampers", format!("dampers of {points} points"), of)),
        }
    }
}

/// A damper parallel to each spring: it pulls with `c_s ċ` along the gradient of what the spring measures.
#[derive(Debug, Clone)]
pub struct Dampers {
    dimension: usize,
    /// The number of points of the model.
    points: usize,
    /// What each damper measures, `[dampers]`; lengths first.
    measures: Vec<Measure>,
    /// The coefficients c_s, in kg/s if the spring measures a length.
    pub coefficients: Vec<f64>,
    /// The index in `dofs` at which the degrees of freedom of each damper begin, `[dampers + 1]`.
    starts: Vec<usize>,
    dofs: Vec<usize>,
}

impl Dampers {
    /// Dampers with `c_s = 2 ζ √(k_s m_s)`, `1/m_s = Σ_i |∂c/∂x_i|²/m_i` over the points that may move.
    ///
    /// With this coefficient a single spring between two free masses has the damping ratio ζ; 1 is critical damping.
    /// `k_s` is the slope of the force of the spring at rest, with its points at `points`, `[points × dimension]`, m;
    /// springs without resistance at rest have no damper. `masses` are in kg, `[points]`.
    ///
    /// # Errors
    /// The ratio is negative, or a point of a spring that may move has no mass.
    pub fn of_ratio(
        network: &Network,
        points: &[f64],
        masses: &[f64],
        support: &Support,
        ratio: f64,
    ) -> Result<Dampers> {
        let d = network.dimension;
        let coefficients = Dampers::coefficients_of_ratio(network, points, masses, support, ratio)?;
        let mut dampers = Dampers {
            dimension: d,
            points: masses.len(),
            measures: Vec::new(),
            coefficients: Vec::new(),
            starts: vec![0],
            dofs: Vec::new(),
        };
        let lengths = network.lengths.iter().map(|s| (&s.points[..], Measure::Length));
        let others = network.others.iter().map(|s| (&s.points[..], s.measure.clone()));
        // A damper of zero would take time in every step.
        for ((nodes, measure), c) in lengths.chain(others).zip(coefficients).filter(|(_, c)| *c > 0.0) {
            dampers.dofs.extend(nodes.iter().flat_map(|p| p * d..(p + 1) * d));
            dampers.starts.push(dampers.dofs.len());
            dampers.measures.push(measure);
            dampers.coefficients.push(c);
        }
        Ok(dampers)
    }

    /// The coefficients c_s of [`Dampers::of_ratio`], `[springs]`, length springs first; zero for springs without
    /// resistance at rest.
    ///
    /// # Errors
    /// As there.
    pub fn coefficients_of_ratio(
        network: &Network,
        points: &[f64],
        masses: &[f64],
        support: &Support,
        ratio: f64,
    ) -> Result<Vec<f64>> {
        if !(ratio >= 0.0 && ratio.is_finite()) {
            return Err(Error::expected("ratio", "a damping ratio that is not negative", ratio));
        }
        let d = network.dimension;
        let place = |nodes: &[usize]| gathered(points, d, nodes);
        let of = |nodes: &[usize], measure: &Measure, x: &[f64], slope: f64| {
            let mut inverse = 0.0;
            let dofs = nodes.iter().flat_map(|p| p * d..(p + 1) * d);
            // What is held counts as an infinite mass, whose inverse adds nothing.
            for (dof, g) in dofs.zip(measure.gradient(x, d)).filter(|(dof, _)| !support.is_fixed(*dof)) {
                if !(masses[dof / d] > 0.0) {
                    let expected = format!("a mass above zero at point {}", dof / d);
                    return Err(Error::expected("masses", expected, masses[dof / d]));
                }
                inverse += g * g / masses[dof / d];
            }
            // A spring that pushes over has no frequency to be damped, and one between held points does not move.
            let damps = slope > 0.0 && inverse > 0.0;
            // Between its points a spring is an oscillator of the stiffness k and the mass `m = 1/Σ g²/m_i`, whose
            // critical damping is `2 √(k m)`.
            Ok(if damps { 2.0 * ratio * (slope / inverse).sqrt() } else { 0.0 })
        };
        let lengths = network.lengths.iter().map(|s| of(&s.points, &Measure::Length, &place(&s.points), s.constant));
        let others = network.others.iter().map(|s| {
            let x = place(&s.points);
            of(&s.points, &s.measure, &x, s.pull(s.measure.value(&x, d))[2])
        });
        lengths.chain(others).collect()
    }

    /// `Σ c_s ∇c_s ∇c_sᵀ` with the points at x, `[points × dimension]`, m, in kg/s.
    pub fn matrix(&self, x: &[f64]) -> Entries {
        let (mut gradients, mut values) = (Vec::new(), Vec::new());
        self.gradients(x, &mut gradients);
        self.entries(&gradients, &mut values);
        self.places().zip(values).map(|((row, column), value)| Triplet::new(row, column, value)).collect()
    }

    /// The positions of the entries of `Σ c_s ∇c_s ∇c_sᵀ` in its lower triangle.
    pub(super) fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let own = |at: &[usize]| &self.dofs[at[0]..at[1]];
        self.starts.windows(2).map(own).flat_map(|dofs| {
            dofs.iter().flat_map(move |&row| {
                dofs.iter().filter(move |column| row >= **column).map(move |&column| (row, column))
            })
        })
    }

    /// `∇c_s` at the positions x, one damper after the other; zero if a damper has no direction.
    pub(super) fn gradients(&self, x: &[f64], gradients: &mut Vec<f64>) {
        let d = self.dimension;
        gradients.clear();
        for (measure, at) in self.measures.iter().zip(self.starts.windows(2)) {
            let dofs = &self.dofs[at[0]..at[1]];
            if let Measure::Length = measure {
                let between = |k: usize| x[dofs[d + k]] - x[dofs[k]];
                let length = (0..d).map(|k| between(k) * between(k)).sum::<f64>().sqrt();
                // Points in one place have no direction between them; the damper pulls again as soon as they part.
                let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
                gradients.extend((0..d).map(|k| -scale * between(k)));
                gradients.extend((0..d).map(|k| scale * between(k)));
            } else {
                let local: Vec<f64> = dofs.iter().map(|&dof| x[dof]).collect();
                let known = |g: f64| if g.is_finite() { g } else { 0.0 };
                gradients.extend(measure.gradient(&local, d).into_iter().map(known));
            }
        }
    }

    /// Adds `Σ c_s ∇c_s (∇c_s·v)`.
    pub(super) fn add_forces(&self, gradients: &[f64], v: &[f64], forces: &mut [f64]) {
        for (coefficient, at) in self.coefficients.iter().zip(self.starts.windows(2)) {
            let (dofs, own) = (&self.dofs[at[0]..at[1]], &gradients[at[0]..at[1]]);
            let rate: f64 = dofs.iter().zip(own).map(|(&dof, g)| g * v[dof]).sum();
            dofs.iter().zip(own).for_each(|(&dof, g)| forces[dof] += coefficient * rate * g);
        }
    }

    /// The values of the entries at [`Dampers::places`].
    pub(super) fn entries(&self, gradients: &[f64], entries: &mut Vec<f64>) {
        entries.clear();
        for (coefficient, at) in self.coefficients.iter().zip(self.starts.windows(2)) {
            let (dofs, own) = (&self.dofs[at[0]..at[1]], &gradients[at[0]..at[1]]);
            for (row, a) in dofs.iter().zip(own) {
                let columns = dofs.iter().zip(own).filter(|(column, _)| row >= *column);
                entries.extend(columns.map(|(_, b)| coefficient * a * b));
            }
        }
    }
}
