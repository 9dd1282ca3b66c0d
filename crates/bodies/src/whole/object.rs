//! A network on its points, with the unknowns of a fit.

use super::gradients::SpringGradients;
use super::unknowns::Unknowns;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::CellFits;
use crate::model::Network;
use crate::solve::Newton;
use crate::springs::{Force, distance};
use std::sync::Arc;

/// A network whose constants are fitted.
#[derive(Debug)]
pub struct Object<'a> {
    /// The network with the constants at θ = 0, which are positive if the springs are linear.
    pub(super) network: Network,
    /// The positions at rest, `[points × dimension]`, m.
    pub(super) points: &'a [f64],
    pub(super) unknowns: Unknowns,
    /// How loads are applied at large displacements; `None` at small displacements.
    pub(super) newton: Option<Newton>,
    /// The gradients at rest.
    pub(super) gradients: Arc<SpringGradients>,
    pub(super) pulls_at_rest: bool,
}

/// Nearly vanishing constants start at this share of the median: large enough to take part in the fit, too small to
/// change the start much.
const LEAST: f64 = 0.03;
/// The share of the median below which a constant is nearly vanishing.
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
        raise(network.others.iter_mut().filter(|s| s.law.is_none()).map(|s| &mut s.constant).collect());
        if network.lengths.iter().any(|s| !(s.constant > 0.0)) {
            let error = Error::expected("springs", "a network with a constant above zero", "none");
            return Err(error.of_kind(ErrorKind::Infeasible));
        }
        if let Some(law) = network.others.iter().filter_map(|s| s.law.as_ref()).find(|law| !law.outer().contains(&true))
        {
            let expected = "laws with a parameter that the force is proportional to";
            return Err(Error::expected("force", expected, format!("\"{}\"", law.text)));
        }
        let (gradients, pulls) = SpringGradients::at(&network, points);
        let slopes = network.lengths.iter().map(|s| s.constant * s.rest);
        let slopes = slopes.chain(network.others.iter().map(|s| s.pull(s.rest)[2] * s.rest));
        let pulls_at_rest = pulls.iter().zip(slopes).any(|(pull, size)| pull.abs() > 1e-9 * size.abs());
        if newton.is_none() && pulls_at_rest {
            return Err(Error::expected("force", "springs that do not pull at rest", "rest lengths of their own"));
        }
        Ok(Object { network, points, unknowns, newton, gradients: Arc::new(gradients), pulls_at_rest })
    }

    /// The unknowns.
    pub fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    /// The force of each spring at factor 1 under small displacements: `T_s = k_s g_s·u`.
    pub(super) fn pulls(&self, u: &[f64]) -> Vec<f64> {
        self.gradients.along(u).zip(self.slopes()).map(|(along, slope)| slope * along).collect()
    }

    /// `∂T_s/∂c_s` at rest, at factor 1.
    pub(super) fn slopes(&self) -> impl Iterator<Item = f64> + '_ {
        let others = self.network.others.iter().map(|s| s.pull(s.rest)[2]);
        self.network.lengths.iter().map(|s| s.constant).chain(others)
    }

    /// The object with equal constants of all length springs, the others equally stiff against the strain of their
    /// measure, and the trace of the stiffness, `Σ_s k_s ‖g_s‖²`, unchanged.
    #[must_use]
    pub fn alike(mut self) -> Object<'a> {
        let d = self.network.dimension;
        let point = |p: usize| &self.points[p * d..(p + 1) * d];
        let trace = |object: &Object| object.slopes().zip(object.gradients.squares()).map(|(k, g)| k * g).sum::<f64>();
        let before = trace(&self);
        let squares = self.network.lengths.iter().map(|s| distance(point(s.points[0]), point(s.points[1])).powi(2));
        let mean = squares.sum::<f64>() / self.network.lengths.len().max(1) as f64;
        self.network.lengths.iter_mut().for_each(|s| s.constant = 1.0);
        for spring in self.network.others.iter_mut().filter(|s| s.law.is_none() && s.rest != 0.0) {
            spring.constant = mean / (spring.rest * spring.rest);
        }
        let after = trace(&self);
        self.scaled(before / after)
    }

    /// The object with all constants multiplied by `factor`.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Object<'a> {
        self.network = self.network.scaled(&vec![factor; self.network.len()]);
        self
    }

    /// The network at θ.
    pub fn network(&self, theta: &[f64]) -> Network {
        self.network.scaled(&self.unknowns.factors(theta))
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
    let Some(median) = positive.get(positive.len() / 2) else { return };
    constants.into_iter().filter(|k| !(**k > NOTHING * median)).for_each(|k| *k = LEAST * median);
}
