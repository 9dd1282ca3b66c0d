//! The differences between the network's displacements and frequencies and the targets.

use super::linearized::{LeastSquares, Linearized};
use super::object::Object;
use super::tangent::Tangent;
use super::target::{Frequencies, Target};
use crate::engine::{Truncated, TruncatedModel};
use crate::error::{Error, ErrorKind, Result};
use crate::model::{BlockStiffness, Elastic, Network, Support, displaced};
use crate::solve::{Equations, KnownPatterns, System};
use rayon::prelude::*;
use std::sync::{Arc, Mutex};

/// The residuals `r_l = √w_l (u_l(θ) − ū_l)/‖ū_l‖` of some loads, and `½ √w_ω ln(ω_i²/ω̄_i²)` of some frequencies.
#[derive(Debug)]
pub struct Displacements<'a> {
    object: &'a Object<'a>,
    pub(super) targets: Vec<&'a Target>,
    frequencies: Option<&'a Frequencies>,
    pub(super) scales: Vec<Vec<f64>>,
    /// Groups of loads with the same support.
    pub(super) groups: Vec<Vec<usize>>,
    /// The patterns of the equations under each support.
    patterns: KnownPatterns,
    /// The patterns of the tangents under each support, which have entries of their own on the diagonal.
    tangents: KnownPatterns,
    /// The last stiffness that was solved by iterations, whose pattern is reused.
    blocks: Mutex<Option<BlockStiffness>>,
    /// The displacements from which the next search for an equilibrium starts.
    guesses: Mutex<Vec<Option<Vec<f64>>>>,
}

/// The displacements under a load, and the tangent there.
type Reached = (Vec<f64>, Tangent);
/// The displacements of every load, and the tangents there.
type Moved = (Vec<Vec<f64>>, Vec<Tangent>);
/// The residuals of the frequencies, and their derivatives in every factor.
type Vibrating = (Vec<f64>, Vec<Vec<f64>>);

/// The relative errors of a network.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Errors {
    /// `‖u_l − ū_l‖_W/‖ū_l‖_W` of each load.
    pub loads: Vec<f64>,
    /// `ω_i/ω̄_i − 1` of each frequency.
    pub frequencies: Vec<f64>,
}

impl<'a> Displacements<'a> {
    /// The residuals of these targets.
    ///
    /// # Errors
    /// A load moves nothing.
    pub fn new(
        object: &'a Object<'a>,
        targets: Vec<&'a Target>,
        frequencies: Option<&'a Frequencies>,
    ) -> Result<Displacements<'a>> {
        if frequencies.is_some() && object.pulls_at_rest() {
            let expected = "springs that do not pull at rest";
            return Err(Error::expected("frequencies", expected, "laws of force or rest lengths that do"));
        }
        let mut scales = Vec::new();
        for target in &targets {
            let nothing = || {
                let expected = "loads under which free points are known to move";
                Error::expected("loads", expected, format!("\"{}\"", target.name))
            };
            scales.push(target.scale().ok_or_else(nothing)?);
        }
        let guesses = Mutex::new(vec![None; targets.len()]);
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (index, target) in targets.iter().enumerate() {
            match groups.iter_mut().find(|group| targets[group[0]].support == target.support) {
                Some(group) => group.push(index),
                None => groups.push(vec![index]),
            }
        }
        // The last group is that of the frequencies.
        let (patterns, tangents) = Default::default();
        let blocks = Mutex::default();
        Ok(Displacements { object, targets, frequencies, scales, groups, patterns, tangents, blocks, guesses })
    }

    /// The number of displacements that are known and free to change, and of frequencies.
    pub fn observations(&self) -> usize {
        let free = |target: &Target| {
            let known = target.weights.iter().zip(&target.support.prescribed);
            known.filter(|(weight, held)| **weight > 0.0 && held.is_none()).count()
        };
        let frequencies = self.frequencies.map_or(0, |frequencies| frequencies.squares.len());
        self.targets.iter().map(|target| free(target)).sum::<usize>() + frequencies
    }

    /// Forgets the displacements from which the next equilibrium is searched. The result at the next θ then depends on
    /// θ alone, to the last bit, and not on the path of the fit.
    pub fn forget(&self) {
        self.guesses.lock().expect("nothing panics while it holds the guesses").fill(None);
    }

    /// The errors of displacements and frequencies at θ; `None` if the network is not stable there.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn errors(&self, theta: &[f64]) -> Result<Option<Errors>> {
        let Some(at) = self.at(theta)? else { return Ok(None) };
        let (loads, rest) = at.residuals.split_at(self.targets.len());
        let error = |(r, t): (&Vec<f64>, &&Target)| (r.iter().map(|r| r * r).sum::<f64>() / t.weight).sqrt();
        let root = self.frequencies.map_or(1.0, |f| f.weight.sqrt());
        Ok(Some(Errors {
            loads: loads.iter().zip(&self.targets).map(error).collect(),
            frequencies: rest.iter().flatten().map(|r| (r / root).exp() - 1.0).collect(),
        }))
    }

    /// The common factor on all constants that minimises the error of the displacements, as far as they are small and
    /// caused by forces, so that `u ∝ 1/α`.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn best_factor(&self, theta: &[f64]) -> Result<Option<f64>> {
        let Some(at) = self.at(theta)? else { return Ok(None) };
        let (mut own, mut both) = (0.0, 0.0);
        for ((target, scale), r) in self.targets.iter().zip(&self.scales).zip(&at.residuals) {
            // What supports prescribe does not depend on the common factor.
            if target.support.prescribed.iter().flatten().any(|u| *u != 0.0) {
                continue;
            }
            for ((wanted, s), r) in target.displacement.iter().zip(scale).zip(r) {
                // The residual is `s (u − ū)`: this is the displacement in its units.
                let u = r + s * wanted;
                own += u * u;
                both += u * s * wanted;
            }
        }
        // All constants times α divide the displacements by α, and `Σ (u/α − ū)²` is least at `α = Σ u²/Σ u ū`.
        Ok(Some(own / both).filter(|alpha| *alpha > 0.0 && alpha.is_finite()))
    }

    /// The equations of each support at θ; `None` if the stiffness at rest is not positive definite.
    fn equations(&self, theta: &[f64], supports: &[&Support]) -> Result<Option<Vec<Equations>>> {
        let object = self.object;
        let Some(solver) = object.iterations else {
            let entries = object.stiffness(theta);
            let one = |support: &&Support| {
                Equations::of_system(self.patterns.renewed(&entries, support, object.points, object.dimension())?)
            };
            return supports.iter().map(one).collect();
        };
        let mut known = self.blocks.lock().expect("nothing panics while it holds the blocks");
        let stiffness = BlockStiffness::of_network(&object.network(theta), object.points, known.as_ref());
        *known = Some(stiffness.clone());
        // Solutions take long and need the pattern no more.
        drop(known);
        let one = |support: &&Support| Equations::iterated(stiffness.clone(), object.points, support, solver);
        supports.iter().map(one).collect()
    }

    /// The displacements of every load, and the tangents there.
    fn small(&self, theta: &[f64]) -> Result<Option<Moved>> {
        if self.object.engine.is_some() {
            return self.in_engine(theta);
        }
        let mut displacements = vec![Vec::new(); self.targets.len()];
        let mut tangents = Vec::new();
        let supports = self.groups.iter().map(|group| &self.targets[group[0]].support);
        let Some(all) = self.equations(theta, &supports.collect::<Vec<_>>())? else { return Ok(None) };
        for (group, equations) in self.groups.iter().zip(all) {
            let forces: Vec<Vec<f64>> = group.iter().map(|&l| self.targets[l].forces.clone()).collect();
            let found = match equations.solve_all(&forces) {
                // A motion without energy, that the iterations have met.
                Err(error) if error.kind() == ErrorKind::Infeasible => return Ok(None),
                found => found?,
            };
            let mut loads = Vec::new();
            for (&l, u) in group.iter().zip(found) {
                loads.push((l, self.object.forces(&u)));
                displacements[l] = u;
            }
            tangents.push(Tangent::Equilibrium { equations, loads });
        }
        Ok(Some((displacements, tangents)))
    }

    /// The displacements of every load in an engine, and the tangents there.
    fn in_engine(&self, theta: &[f64]) -> Result<Option<Moved>> {
        let object = self.object;
        let Some((setting, masses)) = object.engine else { return Ok(None) };
        let (network, factors) = (object.network(theta), object.unknowns.factors(theta));
        let mut displacements = vec![Vec::new(); self.targets.len()];
        let mut tangents = Vec::new();
        for group in &self.groups {
            let model = TruncatedModel { network: &network, points: object.points, masses };
            let support = &self.targets[group[0]].support;
            let Some(truncated) = Truncated::new(model, support, &setting)? else { return Ok(None) };
            let forces: Vec<Vec<f64>> = group.iter().map(|&l| self.targets[l].forces.clone()).collect();
            let predictions = match truncated.predictions(&forces) {
                // The constants are too far from what the sweeps resolve.
                Err(error) if error.kind() == ErrorKind::Limit => return Ok(None),
                found => found?,
            };
            for ((&l, prediction), force) in group.iter().zip(&predictions).zip(&forces) {
                displacements[l] = truncated.displacement(prediction, force);
            }
            let (truncated, loads, factors) = (Box::new(truncated), group.clone(), factors.clone());
            tangents.push(Tangent::Engine { truncated, loads, predictions, factors });
        }
        Ok(Some((displacements, tangents)))
    }

    /// The displacements of every load at large displacements, and the tangents there, a separate one for each load; `None` of a load
    /// without a stable equilibrium.
    fn equilibria(&self, network: &Network) -> Result<Vec<Option<Reached>>> {
        let newton = self.object.newton.expect("this is called at large displacements only");
        let guesses = self.guesses.lock().expect("nothing panics while it holds the guesses").clone();
        let points = self.object.points;
        let Some(patterns) = self.patterns(network)? else { return Ok(self.targets.iter().map(|_| None).collect()) };
        let one = |(l, target): (usize, &&Target)| -> Result<Option<Reached>> {
            let pattern =
                &patterns[self.groups.iter().position(|group| group.contains(&l)).expect("each load has one")];
            // Of a load that is known everywhere the wanted equilibrium is the nearest guess.
            let known = || target.weights.iter().all(|w| *w > 0.0).then_some(&target.displacement);
            let guess = guesses[l].as_ref().or_else(known).map(|guess| &guess[..]);
            let found = newton.reach_stable(network, points, &target.support, &target.forces, guess, pattern)?;
            let Some((u, equations)) = found else { return Ok(None) };
            let Some(forces) = self.object.forces_at(&displaced(points, &u)) else { return Ok(None) };
            Ok(Some((u, Tangent::Equilibrium { equations, loads: vec![(l, forces)] })))
        };
        // Each load has its own equilibrium and its own guess, so that no result depends on the order in which they are
        // found.
        self.targets.par_iter().enumerate().map(one).collect()
    }

    /// The displacements of every load at large displacements, from which the next ones are searched, and the tangents there.
    fn large(&self, network: &Network) -> Result<Option<Moved>> {
        let Some(found) = self.equilibria(network)?.into_iter().collect::<Option<Vec<_>>>() else { return Ok(None) };
        let (displacements, tangents): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let mut guesses = self.guesses.lock().expect("nothing panics while it holds the guesses");
        guesses.iter_mut().zip(&displacements).for_each(|(guess, u)| *guess = Some(u.clone()));
        Ok(Some((displacements, tangents)))
    }

    /// Whether the network has a stable equilibrium under each load at θ. At small displacements it has one under all loads or under none.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn reached(&self, theta: &[f64]) -> Result<Vec<bool>> {
        match self.object.newton {
            None => Ok(vec![self.small(theta)?.is_some(); self.targets.len()]),
            Some(_) => Ok(self.equilibria(&self.object.network(theta))?.iter().map(Option::is_some).collect()),
        }
    }

    /// Equations with the pattern of the tangents under each support, which are analysed once.
    fn patterns(&self, network: &Network) -> Result<Option<Vec<Arc<System>>>> {
        let Some(rest) = network.respond(self.object.points) else { return Ok(None) };
        let one = |group: &Vec<usize>| {
            let support = &self.targets[group[0]].support;
            let (points, dimension) = (self.object.points, self.object.dimension());
            self.tangents.of_steps(&rest.tangent, support, points, dimension)
        };
        self.groups.iter().map(one).collect::<Result<_>>().map(Some)
    }

    /// The residuals of the frequencies and the derivative `∂/∂c_s = ½ √w φ_iᵀ K_s φ_i/ω_i²` of each.
    fn vibrations(&self, theta: &[f64]) -> Result<Option<Vibrating>> {
        let Some(wanted) = self.frequencies else { return Ok(Some((Vec::new(), Vec::new()))) };
        let (object, count) = (self.object, wanted.squares.len());
        let Some(equations) = self.equations(theta, &[&wanted.support])? else { return Ok(None) };
        let modes = equations[0].lowest_modes(&wanted.masses, object.dimension(), count)?;
        // The residual is the logarithm of the quotient of frequencies, half of that of their squares.
        let root = 0.5 * wanted.weight.sqrt();
        let residuals = modes.squares.iter().zip(&wanted.squares).map(|(a, b)| root * (a / b).ln()).collect();
        let row = |(square, shape): (&f64, &Vec<f64>)| {
            object.energies(shape).into_iter().map(|energy| root * energy / square).collect()
        };
        Ok(Some((residuals, modes.squares.iter().zip(&modes.shapes).map(row).collect())))
    }
}

impl LeastSquares for Displacements<'_> {
    fn unknowns(&self) -> usize {
        self.object.unknowns.count()
    }

    fn at(&self, theta: &[f64]) -> Result<Option<Linearized<'_>>> {
        let small = self.object.newton.is_none();
        let found = if small { self.small(theta)? } else { self.large(&self.object.network(theta))? };
        let Some((displacements, tangents)) = found else { return Ok(None) };
        let residual = |(l, u): (usize, Vec<f64>)| {
            let lack = u.iter().zip(&self.targets[l].displacement).zip(&self.scales[l]);
            lack.map(|((u, wanted), s)| s * (u - wanted)).collect()
        };
        let mut residuals: Vec<Vec<f64>> = displacements.into_iter().enumerate().map(residual).collect();
        let Some((lacks, rows)) = self.vibrations(theta)? else { return Ok(None) };
        // Without frequencies no vector of theirs follows those of the loads.
        residuals.extend((!rows.is_empty()).then_some(lacks));
        let (unknowns, scales) = (&self.object.unknowns, &self.scales[..]);
        Ok(Some(Linearized { residuals, theta: theta.to_vec(), unknowns, tangents, scales, rows }))
    }
}
