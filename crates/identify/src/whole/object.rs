//! A network on its points, with the unknowns of a fit.

use super::moduli::{ModuliParts, ModuliSharing};
use super::unknowns::Unknowns;
use crate::engine::Setting;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::CellFits;
use crate::model::{Entries, Network, PartVectors, SpringGradients};
use crate::solve::{Newton, StaticSolver};
use crate::springs::{Force, distance};
use std::collections::BTreeMap;

/// A network whose constants are fitted.
#[derive(Debug)]
pub struct Object<'a> {
    pub(super) model: Model<'a>,
    /// The positions at rest, `[points × dimension]`, m.
    pub(super) points: &'a [f64],
    pub(super) unknowns: Unknowns,
    /// How loads are applied at large displacements; `None` at small displacements.
    pub(super) newton: Option<Newton>,
    /// How equations are solved by iterations; `None` stands for factors.
    pub(super) iterations: Option<StaticSolver>,
    /// The engine that moves the network, and the masses, `[points]`, kg; `None` where equations are solved to the end.
    pub(super) engine: Option<(Setting, &'a [f64])>,
}

/// The parts that the unknowns multiply, at θ = 0.
#[derive(Debug)]
pub(super) enum Model<'a> {
    /// The springs of a network.
    Springs(SpringParts),
    /// The cells of an exact network, for each modulus.
    Moduli(ModuliParts<'a>),
}

/// The springs of a network as parts.
#[derive(Debug)]
pub(super) struct SpringParts {
    /// The constants are positive if the springs are linear.
    pub network: Network,
    /// The gradients at rest.
    gradients: SpringGradients,
    pub pulls_at_rest: bool,
}

/// Nearly vanishing constants start at this share of the median: large enough to take part in the fit, too small to
/// change the start much.
// Errors of fits to a cube of 412 tetrahedra, under loads that were not fitted, are the same to 3 % with shares of 0.01
// to 1. With 0.003 each ρ exceeds the range of constants that is allowed.
const LEAST: f64 = 0.03;
/// The share of the median below which a constant is nearly vanishing.
// Shares of 1e-6 to 1e-2 leave errors there that differ by 1 %: few constants lie between.
const NOTHING: f64 = 1e-4;

impl<'a> Object<'a> {
    /// `newton` says how loads are applied at large displacements; `None` stands for small displacements.
    ///
    /// # Errors
    /// The network has no springs, or none with a positive constant; at small displacements a spring pulls at rest; or
    /// a law has no factor.
    pub fn new(network: &Network, points: &'a [f64], unknowns: Unknowns, newton: Option<Newton>) -> Result<Object<'a>> {
        if network.is_empty() {
            return Err(Error::expected("springs", "a network with springs", "none").of_kind(ErrorKind::Infeasible));
        }
        let mut network = network.clone();
        raise(network.lengths.iter_mut().map(|s| &mut s.constant).collect());
        // Apart from the lengths: constants of other kinds have other units, and a common median would mean nothing.
        raise(network.others.iter_mut().filter(|s| s.law.is_none()).map(|s| &mut s.constant).collect());
        if network.lengths.iter().any(|s| !(s.constant > 0.0)) {
            let error = Error::expected("springs", "a network with a constant above zero", "none");
            return Err(error.of_kind(ErrorKind::Infeasible));
        }
        if let Some(own) =
            network.others.iter().filter_map(|s| s.law.as_ref()).find(|own| !own.law.outer().contains(&true))
        {
            let expected = "laws with a parameter that the force is proportional to";
            return Err(Error::expected("force", expected, format!("\"{}\"", own.law.text)));
        }
        let (gradients, pulls) = SpringGradients::at(&network, points);
        let slopes = network.lengths.iter().map(|s| s.constant * s.rest);
        let slopes = slopes.chain(network.others.iter().map(|s| s.pull(s.rest)[2] * s.rest));
        // Rest lengths of a file pull by the rounding of its digits.
        let pulls_at_rest = pulls.iter().zip(slopes).any(|(pull, size)| pull.abs() > 1e-9 * size.abs());
        if newton.is_none() && pulls_at_rest {
            return Err(Error::expected("force", "springs that do not pull at rest", "rest lengths of their own"));
        }
        let model = Model::Springs(SpringParts { network, gradients, pulls_at_rest });
        Ok(Object { model, points, unknowns, newton, iterations: None, engine: None })
    }

    /// An exact network whose unknowns are moduli. `newton` says how loads are applied at large displacements; `None` stands for small
    /// ones.
    ///
    /// # Errors
    /// The unknowns are not those of these parts, or the parts are those of small deformations and displacements are large.
    pub fn of_moduli(parts: ModuliParts<'a>, unknowns: Unknowns, newton: Option<Newton>) -> Result<Object<'a>> {
        if parts.len() != unknowns.springs() {
            return Err(Error::expected("unknowns", format!("those of {} parts", parts.len()), unknowns.springs()));
        }
        if newton.is_some() && !parts.is_large() {
            return Err(Error::expected("unknowns", "parts of a network at large deformation", "those of small ones"));
        }
        let points = &parts.mesh().points;
        Ok(Object { model: Model::Moduli(parts), points, unknowns, newton, iterations: None, engine: None })
    }

    /// The object whose equations at small displacements are solved by iterations, in memory that grows like its springs.
    #[must_use]
    pub fn iterated(self, iterations: Option<StaticSolver>) -> Object<'a> {
        Object { iterations, ..self }
    }

    /// The object as an engine moves it at small displacements, with these masses, `[points]`, kg.
    #[must_use]
    pub fn in_engine(self, engine: Option<(Setting, &'a [f64])>) -> Object<'a> {
        Object { engine, ..self }
    }

    /// The unknowns.
    pub fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    /// The forces of each part at factor 1 under small displacements.
    pub(super) fn forces(&self, u: &[f64]) -> PartVectors {
        match &self.model {
            Model::Springs(parts) => {
                let pulls = parts.gradients.along(u).zip(parts.slopes()).map(|(along, slope)| slope * along);
                parts.gradients.forces(pulls)
            }
            Model::Moduli(parts) => parts.forces(u),
        }
    }

    /// The forces of each part at factor 1 with the points at x; `None` if only small displacements matter.
    pub(super) fn forces_at(&self, x: &[f64]) -> Option<PartVectors> {
        match &self.model {
            Model::Springs(parts) => {
                let (gradients, pulls) = SpringGradients::at(&parts.network, x);
                Some(gradients.forces(pulls.into_iter()))
            }
            Model::Moduli(parts) => parts.forces_at(x),
        }
    }

    /// `uᵀ K_s u` of each part at factor 1, under small displacements.
    pub(super) fn energies(&self, u: &[f64]) -> Vec<f64> {
        match &self.model {
            Model::Springs(parts) => {
                parts.gradients.along(u).zip(parts.slopes()).map(|(along, slope)| slope * along * along).collect()
            }
            Model::Moduli(parts) => parts.forces(u).along(u).collect(),
        }
    }

    /// Whether springs pull at rest in such a way that natural frequencies have no derivatives here.
    pub(super) fn pulls_at_rest(&self) -> bool {
        match &self.model {
            Model::Springs(parts) => parts.pulls_at_rest,
            Model::Moduli(_) => false,
        }
    }

    /// The stiffness at rest, N/m.
    pub(super) fn stiffness(&self, theta: &[f64]) -> Entries {
        match &self.model {
            Model::Springs(_) => self.network(theta).stiffness(self.points),
            Model::Moduli(parts) => parts.stiffness(&self.unknowns.factors(theta)),
        }
    }

    /// The number of coordinates of a point.
    pub(super) fn dimension(&self) -> usize {
        match &self.model {
            Model::Springs(parts) => parts.network.dimension,
            Model::Moduli(parts) => parts.mesh().dimension,
        }
    }

    /// The object with equal constants of all length springs, the others equally stiff against the strain of their
    /// measure, and the trace of the stiffness, `Σ_s k_s ‖g_s‖²`, unchanged. Moduli are as they were.
    #[must_use]
    pub fn alike(mut self) -> Object<'a> {
        if let Model::Springs(parts) = &mut self.model {
            parts.equalize(self.points);
        }
        self
    }

    /// The object with all constants multiplied by `factor`.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Object<'a> {
        match &mut self.model {
            Model::Springs(parts) => parts.scale(factor),
            Model::Moduli(parts) => *parts = parts.scaled(&vec![factor; parts.len()]),
        }
        self
    }

    /// The network at θ.
    pub fn network(&self, theta: &[f64]) -> Network {
        let factors = self.unknowns.factors(theta);
        match &self.model {
            Model::Springs(parts) => parts.network.scaled(&factors),
            Model::Moduli(parts) => parts.network(&factors),
        }
    }

    /// The names of the unknowns that cells share in this way; none if the unknowns are no moduli.
    pub fn modulus_names(&self, sharing: ModuliSharing) -> Vec<String> {
        match &self.model {
            Model::Springs(_) => Vec::new(),
            Model::Moduli(parts) => parts.names(sharing),
        }
    }

    /// The factor of each unknown on the modulus of the material at θ; `None` if the unknowns are no moduli.
    pub fn modulus_factors(&self, theta: &[f64]) -> Option<Vec<f64>> {
        let Model::Moduli(parts) = &self.model else { return None };
        let mut found = vec![1.0; self.unknowns.count()];
        let own = parts.factors().iter().zip(self.unknowns.factors(theta));
        for (unknown, (before, factor)) in self.unknowns.owners().zip(own) {
            found[unknown] = before * factor;
        }
        Some(found)
    }

    /// The factors on μ and λ of the cells that belong to the same groups, at θ: those of any of them; none if the unknowns are no
    /// moduli.
    pub fn region_factors(&self, theta: &[f64]) -> BTreeMap<Vec<String>, [f64; 2]> {
        match &self.model {
            Model::Springs(_) => BTreeMap::new(),
            Model::Moduli(parts) => parts.region_factors(&self.unknowns.factors(theta)),
        }
    }

    /// The ratio of the largest to the least constant of the length springs at θ, or of the largest to the least factor on a
    /// modulus.
    pub(super) fn range(&self, theta: &[f64]) -> f64 {
        match &self.model {
            Model::Springs(parts) => parts.network.scaled(&self.unknowns.factors(theta)).range(),
            Model::Moduli(_) => {
                let largest = theta.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                (largest - theta.iter().copied().fold(f64::INFINITY, f64::min)).exp()
            }
        }
    }
}

impl SpringParts {
    /// `∂T_s/∂c_s` at rest, at factor 1.
    fn slopes(&self) -> impl Iterator<Item = f64> + '_ {
        let others = self.network.others.iter().map(|s| s.pull(s.rest)[2]);
        self.network.lengths.iter().map(|s| s.constant).chain(others)
    }

    fn equalize(&mut self, points: &[f64]) {
        let d = self.network.dimension;
        let point = |p: usize| &points[p * d..(p + 1) * d];
        let trace =
            |parts: &SpringParts| parts.slopes().zip(parts.gradients.squares()).map(|(k, g)| k * g).sum::<f64>();
        let before = trace(self);
        let squares = self.network.lengths.iter().map(|s| distance(point(s.points[0]), point(s.points[1])).powi(2));
        let mean = squares.sum::<f64>() / self.network.lengths.len().max(1) as f64;
        self.network.lengths.iter_mut().for_each(|s| s.constant = 1.0);
        // The constant of a law is not its stiffness, and a measure that is zero at rest has no strain.
        for spring in self.network.others.iter_mut().filter(|s| s.law.is_none() && s.rest != 0.0) {
            spring.constant = mean / (spring.rest * spring.rest);
        }
        let after = trace(self);
        self.scale(before / after);
    }

    fn scale(&mut self, factor: f64) {
        self.network = self.network.scaled(&vec![factor; self.network.len()]);
    }
}

/// Raises nearly vanishing constants of linear springs to a share of the median of those in the same group, so that the
/// fit can change them; the unknowns are factors, and zero times a factor stays zero.
pub fn raise_idle(fits: &mut [CellFits]) {
    for fit in fits.iter_mut().filter(|fit| fit.force == Force::Linear) {
        let m = fit.springs.len().max(1);
        for group in 0..fit.springs.names().len() {
            let own = |place: usize| fit.springs.groups()[place % m] == group;
            raise(fit.constants.iter_mut().enumerate().filter(|(place, _)| own(*place)).map(|(_, k)| k).collect());
        }
    }
}

/// Raises nearly vanishing values to a share of the median of the positive ones.
fn raise(constants: Vec<&mut f64>) {
    let mut positive: Vec<f64> = constants.iter().map(|k| **k).filter(|k| *k > 0.0).collect();
    positive.sort_by(f64::total_cmp);
    // Without a positive constant there is no scale; the caller refuses such springs on lengths.
    let Some(median) = positive.get(positive.len() / 2) else { return };
    // The comparison is negated so that constants below zero and those that are not numbers are raised too.
    constants.into_iter().filter(|k| !(**k > NOTHING * median)).for_each(|k| *k = LEAST * median);
}
