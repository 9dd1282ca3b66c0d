//! The moduli that a whole-object fit has found, with their intervals.

use super::outcome::{FoundModuli, FoundModulus};
use super::recipe::WholeRecipe;
use crate::error::Result;
use crate::whole::{
    Determination, Displacements, ModuliSharing, NINETY_FIVE, Object, Validation, WEAK, Wanted, WholeFit,
    WholeSettings, fit_whole,
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
    let free = |known: &Determination| -> Result<Vec<f64>> {
        if found.cancelled || known.shifts.iter().all(|shift| shift.abs() < NEAR) {
            return Ok(known.shifts.clone());
        }
        let wanted = Wanted { validation: Validation::None, ..wanted.clone() };
        let settings = WholeSettings { regularizations: vec![0.0], ..recipe.settings.clone() };
        let free = fit_whole(object, &wanted, &settings, None, &mut |_| true)?;
        Ok(free.theta.iter().zip(&found.theta).map(|(free, own)| free - own).collect())
    };
    // Too many unknowns are not tried, and fewer displacements than unknowns determine none of them.
    let known = Determination::of(&problem, &found.theta, wanted.noise).ok();
    let shifts = known.as_ref().map(free).transpose()?.unwrap_or_default();
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
    let misfit = known.as_ref().zip(wanted.noise).map(|(known, noise)| known.residual / noise);
    Ok(FoundModuli { all, weak, misfit })
}
