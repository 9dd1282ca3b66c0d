//! Moduli of a body from measured displacements, with a coarse network for the derivatives and a finer mesh for the displacements.
//!
//! Theory: page *Whole-object fits* of the book.

use super::body::WholeBody;
use super::evidence::Evidence;
use super::finer_steps::{FinerPoint, FinerSteps};
use super::recipe::{Start, ValidationRecipe, WholeRecipe};
use crate::body::FinerBody;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::VolumeSprings;
use crate::progress::Progress;
use crate::whole::{Determination, Displacements, Object, Target, Wanted, WholeFit, fit_whole};

/// Corrections at most. They are cheap, and need not settle: steps on the finer body follow.
const ROUNDS: usize = 4;
/// A correction of logarithms of moduli that is near enough for steps on the finer body.
const NEAR: f64 = 1e-2;

/// A fit whose displacements are those of a finer body.
pub(super) struct Corrected {
    pub found: WholeFit,
    /// The loads with the displacements that the network has where the finer body has those that were measured.
    pub wanted: Wanted,
    /// The deviation of each unknown that the meshes cause.
    pub deviations: Vec<f64>,
    /// What the measured displacements say of the moduli of the finer body.
    pub evidence: Evidence,
}

impl WholeBody<'_> {
    /// Whether the loads of the fit are measured.
    ///
    /// # Errors
    /// Moduli are found from some that are measured and some that are not: displacements of finite elements with the moduli of the scene are
    /// no data.
    pub(super) fn is_measured(&self, recipe: &WholeRecipe, wanted: &Wanted) -> Result<bool> {
        if wanted.trained.iter().all(|target| self.measured(target).is_none()) {
            return Ok(false);
        }
        let other = wanted.trained.iter().find(|target| self.measured(target).is_none());
        match other.filter(|_| recipe.unknowns.moduli().is_some()) {
            Some(other) => {
                let expected = "loads with measured displacements alone, where moduli are found from some";
                Err(Error::expected("loads", expected, format!("{}, which has none", other.name)))
            }
            None => Ok(true),
        }
    }

    /// The number of the load of the scene whose measured displacements these are.
    pub(super) fn measured(&self, target: &Target) -> Option<usize> {
        self.cases.iter().position(|case| case.is_measured && case.name == target.name)
    }

    /// In words, of a fit with measured displacements: the loads of the fit and of its validation that are not measured, and those of the scene
    /// where the moduli that are found are not those of the finite elements.
    pub(super) fn guessed(&self, recipe: &WholeRecipe, wanted: &Wanted) -> [Vec<String>; 2] {
        let named = |targets: &[Target]| -> Vec<String> {
            let known = targets.iter().filter(|target| self.cases.iter().any(|case| case.name == target.name));
            known.filter(|target| self.measured(target).is_none()).map(|target| target.name.clone()).collect()
        };
        let mut guessed = named(&wanted.trained);
        guessed.extend(named(wanted.validation.loads()));
        let is_judged = matches!(&recipe.validation, ValidationRecipe::Loads(loads) if loads.made);
        guessed.extend((recipe.loads.made || is_judged).then(|| "loads made from the mesh".into()));
        let cases = self.cases.iter().filter(|case| !case.is_measured && recipe.unknowns.moduli().is_some());
        [guessed, cases.map(|case| case.name.clone()).collect()]
    }

    /// Finds the moduli with which the finer body moves as measured: fits of the network to `ū − (u_fine(θ) − u(θ))` with the last θ come near,
    /// and steps on the finer body end there.
    ///
    /// # Errors
    /// The moduli do not settle, or the finer body lacks a region.
    pub(super) fn corrected(
        &self,
        recipe: &WholeRecipe,
        fine: &FinerBody,
        (object, wanted): (&Object, &Wanted),
        found: WholeFit,
        progress: &mut Progress,
    ) -> Result<Corrected> {
        if self.newton.is_some() {
            let expected = "a material without a law, where moduli come from measurements with [reference]";
            return Err(Error::expected("unknowns", expected, "one with a law").of_kind(ErrorKind::Unsupported));
        }
        if matches!(recipe.start, Start::Exact(_, VolumeSprings::Patches)) {
            let expected = "\"points\" or \"cells\", where moduli come from measurements with [reference]";
            return Err(Error::expected("volume", expected, "\"patches\""));
        }
        let loads: Vec<usize> = wanted.trained.iter().filter_map(|target| self.measured(target)).collect();
        let first = found.theta.clone();
        let steps = FinerSteps { fine, object, measured: &wanted.trained, loads: &loads };
        let (mut now, mut own) = (found, wanted.clone());
        let mut last = f64::INFINITY;
        for _ in 0..ROUNDS {
            let far = fine.moved(&loads, &object.region_factors(&now.theta), progress)?;
            own.trained = self.shifted(object, wanted, (&now.theta, &far))?;
            let next = fit_whole(object, &own, &recipe.settings, None, &mut |_| !self.controls.cancelled())?;
            let step = now.theta.iter().zip(&next.theta).fold(0.0, |a: f64, (a0, b)| a.max((a0 - b).abs()));
            // Corrections that grow lead away.
            if !(step < last) {
                break;
            }
            (now, last) = (next, step);
            if step < NEAR || now.cancelled {
                break;
            }
        }
        // The error of the finer mesh, if errors fall like the square of the size of the cells.
        // Both meshes differ by the error of the coarse one less that of the fine one, which is `c² − 1` times the
        // latter. Meshes of about one size tell nothing of it: their whole difference counts.
        let rest = (fine.coarseness(self.mesh).powi(2) - 1.0).max(1.0);
        let deviations = |theta: &[f64], step: f64| {
            first.iter().zip(theta).map(|(first, last)| ((last - first) / rest).hypot(step)).collect()
        };
        if now.cancelled {
            let (evidence, deviations) = (Evidence::of_network(object, &own, &now)?, deviations(&now.theta, last));
            return Ok(Corrected { found: now, wanted: own, deviations, evidence });
        }
        // A fit that has kept its start is one with more than the largest ρ.
        let rho = now.regularization.or(recipe.settings.regularizations.first().copied()).unwrap_or(0.0);
        let point = steps.settle(&now.theta, rho, progress)?;
        own.trained = self.shifted(object, wanted, (&point.theta, &point.moved))?;
        let found = now.moved(object, &own, &point.theta)?;
        let seen = Displacements::new(object, wanted.trained.iter().collect(), None)?.observations();
        let sees = |point: &FinerPoint| Determination::by(&point.columns, &point.residuals, seen, wanted.noise).ok();
        let mut evidence = Evidence::at(sees(&point), wanted.noise);
        if !evidence.is_near() {
            let free = steps.settle(&point.theta, 0.0, progress);
            evidence = evidence.free(&point.theta, free.map(|free| (sees(&free), free.theta)).ok());
        }
        Ok(Corrected { found, wanted: own, deviations: deviations(&point.theta, point.step), evidence })
    }

    /// The loads with `ū − (u_fine − u(θ))`, the displacements that the network has at θ where the finer body moves as measured.
    fn shifted(&self, object: &Object, wanted: &Wanted, (theta, far): (&[f64], &[Vec<f64>])) -> Result<Vec<Target>> {
        let network = object.network(theta);
        let one = |(raw, far): (&Target, &Vec<f64>)| {
            let unstable = || Error::expected("network", "a stable one", "one that is not");
            let equations = self.equations_of(&network, &raw.support)?.ok_or_else(unstable)?;
            let near = equations.solve(&raw.forces)?.0;
            let moved = far.iter().zip(&near).map(|(far, near)| far - near);
            let displacement = raw.displacement.iter().zip(moved).map(|(u, moved)| u - moved).collect();
            let mut target = Target { displacement, ..raw.clone() };
            // The residuals keep their unit.
            target.weight = raw.weight * size(&target) / size(raw);
            Ok(target)
        };
        wanted.trained.iter().zip(far).map(one).collect()
    }
}

/// `‖ū‖²` where it is known.
fn size(target: &Target) -> f64 {
    target.displacement.iter().zip(&target.weights).map(|(u, w)| w * u * u).sum()
}
