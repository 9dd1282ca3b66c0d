//! Moduli of a body from measured displacements, with a coarse network for the derivatives and a finer mesh for the displacements.
//!
//! Theory: page *Whole-object fits* of the book.

use super::body::WholeBody;
use super::recipe::{Start, WholeRecipe};
use crate::error::{Error, Result};
use crate::fit::VolumeSprings;
use crate::study::progress::{Event, Progress};
use crate::whole::{Object, Target, Wanted, WholeFit, fit_whole};

/// Corrections at most.
const ROUNDS: usize = 8;
/// A correction of logarithms of moduli that counts as none.
const SETTLED: f64 = 1e-4;

/// A fit whose displacements are those of a finer body.
pub(super) struct Corrected {
    pub found: WholeFit,
    /// The loads with the displacements that the network has where the finer body has those that were measured.
    pub wanted: Wanted,
    /// The deviation of each unknown that the meshes cause.
    pub deviations: Vec<f64>,
}

impl WholeBody<'_> {
    /// Whether the unknowns are few moduli, the loads of the fit are measured, and there is a finer body.
    ///
    /// # Errors
    /// Some loads are measured and some are not: the displacements of the finer body, with the moduli at the start, are no data.
    pub(super) fn is_corrected(&self, recipe: &WholeRecipe, wanted: &Wanted) -> Result<bool> {
        if self.fine.is_none() || !recipe.is_of_few_moduli() {
            return Ok(false);
        }
        match wanted.trained.iter().find(|target| self.measured(target).is_none()) {
            None => Ok(true),
            Some(other) if wanted.trained.iter().any(|target| self.measured(target).is_some()) => {
                let expected = "loads with measured displacements alone, where moduli are found from some and there is [reference]";
                Err(Error::expected("loads", expected, format!("{}, which has none", other.name)))
            }
            Some(_) => Ok(false),
        }
    }

    /// The number of the load of the scene whose measured displacements these are.
    pub(super) fn measured(&self, target: &Target) -> Option<usize> {
        self.cases.iter().position(|case| case.is_measured && case.name == target.name)
    }

    /// Fits the network to `ū − (u_fine(θ) − u(θ))` with the last θ, until θ stays: then the finer body has the measured displacements.
    ///
    /// # Errors
    /// The moduli do not settle, or the finer body lacks a region.
    pub(super) fn corrected(
        &self,
        recipe: &WholeRecipe,
        (object, wanted): (&Object, &Wanted),
        found: WholeFit,
        progress: &mut Progress,
    ) -> Result<Corrected> {
        let fine = self.fine.ok_or_else(|| Error::expected("reference", "a finer mesh", "none"))?;
        if matches!(recipe.start, Start::Exact(_, VolumeSprings::Patches)) {
            let expected = "\"points\" or \"cells\", where moduli come from measurements with [reference]";
            return Err(Error::expected("volume", expected, "\"patches\""));
        }
        let loads: Vec<usize> = wanted.trained.iter().filter_map(|target| self.measured(target)).collect();
        let first = found.theta.clone();
        let mut now = Corrected { found, wanted: wanted.clone(), deviations: Vec::new() };
        let mut step = f64::INFINITY;
        for _ in 0..ROUNDS {
            let theta = now.found.theta.clone();
            let far = fine.moved(&loads, &object.region_factors(&theta), progress)?;
            let network = object.network(&theta);
            for ((target, raw), far) in now.wanted.trained.iter_mut().zip(&wanted.trained).zip(far) {
                let unstable = || Error::expected("network", "a stable one", "one that is not");
                let equations = self.equations_of(&network, &target.support)?.ok_or_else(unstable)?;
                let near = equations.solve(&target.forces)?.0;
                let moved = far.iter().zip(&near).map(|(far, near)| far - near);
                target.displacement = raw.displacement.iter().zip(moved).map(|(u, moved)| u - moved).collect();
                // The residuals keep their unit.
                target.weight = raw.weight * size(target) / size(raw);
            }
            now.found = fit_whole(object, &now.wanted, &recipe.settings, None, &mut |_| !self.controls.cancelled())?;
            let last = step;
            step = theta.iter().zip(&now.found.theta).fold(0.0, |a: f64, (a0, b)| a.max((a0 - b).abs()));
            if step < SETTLED || now.found.cancelled {
                break;
            }
            if !(step < last) {
                let problem = format!(
                    "the moduli do not settle between the mesh and the finer one: they change by {:.1} % after {:.1} %; a finer mesh \
                     of the scene is needed",
                    100.0 * step,
                    100.0 * last
                );
                return Err(Error::at("unknowns", problem));
            }
        }
        if !(step < SETTLED || now.found.cancelled) {
            let change = 100.0 * step;
            let words =
                format!("moduli still change by {change:.2} % after {ROUNDS} corrections; intervals have this change");
            progress(Event::Note(&words));
        }
        // The error of the finer mesh, if errors fall like the square of the size of the cells.
        let rest = (fine.coarseness(self.mesh).powi(2) - 1.0).max(1.0);
        let deviation = |(first, last): (&f64, &f64)| ((last - first) / rest).hypot(step);
        now.deviations = first.iter().zip(&now.found.theta).map(deviation).collect();
        Ok(now)
    }
}

/// `‖ū‖²` where it is known.
fn size(target: &Target) -> f64 {
    target.displacement.iter().zip(&target.weights).map(|(u, w)| w * u * u).sum()
}
