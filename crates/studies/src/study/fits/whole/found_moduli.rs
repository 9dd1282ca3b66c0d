//! The moduli that a whole-object fit has found, with their intervals.

use super::moduli::{FoundModuli, FoundModulus, ModuliSearch};
use super::recipe::WholeRecipe;
use crate::error::Result;
use crate::whole::{
    Best, Determination, Displacements, ModuliSharing, NINETY_FIVE, Object, Snapshot, Validation, WEAK, Wanted,
    WholeFit, WholeSettings, fit_whole,
};

/// The step to the optimum without ρ from which on linearisation is not enough to know that optimum.
const NEAR: f64 = 0.02;

/// The moduli of the body or its regions with their intervals, if these are the unknowns. `mesh` has the deviations of their logarithms
/// that the meshes cause, if they are known.
pub(super) fn found_moduli(
    recipe: &WholeRecipe,
    object: &Object,
    wanted: &Wanted,
    found: &WholeFit,
    mesh: &[f64],
) -> Result<FoundModuli> {
    let sharing = recipe.unknowns.moduli().filter(|sharing| *sharing != ModuliSharing::Element && found.stands);
    let Some(sharing) = sharing else { return Ok(FoundModuli::default()) };
    let names = object.modulus_names(sharing);
    let factors = object.modulus_factors(&found.theta).unwrap_or_default();
    let problem = Displacements::new(object, wanted.trained.iter().collect(), None)?;
    let is_near = |shifts: &[f64]| shifts.iter().all(|shift| shift.abs() < NEAR);
    // Too many unknowns are not tried, and fewer displacements than unknowns determine none of them.
    let mut known = Determination::of(&problem, &found.theta, wanted.noise).ok();
    let misfit = known.as_ref().zip(wanted.noise).map(|(known, noise)| known.residual / noise);
    let mut shifts = known.as_ref().map_or_else(Vec::new, |known| known.shifts.clone());
    let mut search = ModuliSearch::Finished;
    if !found.cancelled && !is_near(&shifts) {
        // By the default method from where the fit has ended: it is the fit that may have ended early, by its own method and limit.
        let free = Wanted { validation: Validation::None, ..wanted.clone() };
        let settings = WholeSettings { regularizations: vec![0.0], ..WholeSettings::default() };
        let best = Best { error: None, theta: found.theta.clone(), stage: None };
        let (theta, curve, left_out) = (found.theta.clone(), Vec::new(), Vec::new());
        let from = Snapshot { stage: 0, theta, best, curve, left_out };
        let free = fit_whole(object, &free, &settings, Some(from), &mut |_| true)?;
        // What the displacements say there, where they would put the moduli; the last part of the way is linear.
        known = Determination::of(&problem, &free.theta, wanted.noise).ok();
        let rest = known.as_ref().map_or_else(|| vec![f64::INFINITY; shifts.len()], |known| known.shifts.clone());
        let is_optimal = is_near(&rest);
        shifts = free.theta.iter().zip(&found.theta).zip(&rest).map(|((free, own), rest)| free + rest - own).collect();
        let chosen = found.curve.iter().find(|stage| Some(stage.regularization) == found.regularization);
        search = match (is_optimal, chosen.is_none_or(|stage| stage.is_finished)) {
            (false, _) => ModuliSearch::Lost,
            (true, false) => ModuliSearch::Ended,
            (true, true) => ModuliSearch::Finished,
        };
    }
    let reach = |p: usize| {
        let noise = known.as_ref()?.deviations[p]?;
        Some(NINETY_FIVE * noise.hypot(mesh.get(p).copied().unwrap_or(0.0)))
    };
    let modulus = |(p, (name, factor)): (usize, (&String, f64))| {
        // From the value that was found to the one without ρ, and the deviations beyond either end.
        let ends =
            |reach: f64| [factor * (shifts[p].min(0.0) - reach).exp(), factor * (shifts[p].max(0.0) + reach).exp()];
        FoundModulus { name: name.clone(), factor, interval: reach(p).map(ends), mesh: mesh.get(p).copied() }
    };
    let all: Vec<FoundModulus> = names.iter().zip(factors).enumerate().map(modulus).collect();
    let together = |unknowns: &Vec<usize>| unknowns.iter().map(|p| names[*p].clone()).collect::<Vec<_>>().join(", ");
    let mut weak: Vec<String> = known.iter().flat_map(|known| known.weak.iter().map(together)).collect();
    weak.dedup();
    for (p, modulus) in all.iter().enumerate() {
        let is_listed = known.iter().any(|known| known.weak.iter().any(|together| together.contains(&p)));
        if !is_listed && reach(p).is_some_and(|reach| reach > WEAK.ln()) {
            weak.push(modulus.name.clone());
        }
    }
    Ok(FoundModuli { all, weak, misfit, search })
}
