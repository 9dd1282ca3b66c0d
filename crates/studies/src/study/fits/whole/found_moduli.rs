//! The moduli that a whole-object fit has found, with their intervals.

use super::outcome::{FoundModuli, FoundModulus};
use super::recipe::WholeRecipe;
use crate::error::Result;
use crate::whole::{Determination, Displacements, ModuliSharing, NINETY_FIVE, Object, Wanted, WholeFit};

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
    // Too many unknowns are not tried, and fewer displacements than unknowns determine none of them.
    let known = Determination::of(&problem, &found.theta, wanted.noise).ok();
    let modulus = |(p, (name, factor)): (usize, (&String, f64))| {
        let noise = known.as_ref().and_then(|known| known.deviations[p]);
        let ends = |noise: f64| {
            let deviation = noise.hypot(mesh.get(p).copied().unwrap_or(0.0));
            [factor * (-NINETY_FIVE * deviation).exp(), factor * (NINETY_FIVE * deviation).exp()]
        };
        FoundModulus { name: name.clone(), factor, interval: noise.map(ends), mesh: mesh.get(p).copied() }
    };
    let all = names.iter().zip(factors).enumerate().map(modulus).collect();
    let together = |unknowns: &Vec<usize>| unknowns.iter().map(|p| names[*p].clone()).collect::<Vec<_>>().join(", ");
    let weak = known.iter().flat_map(|known| known.weak.iter().map(together)).collect();
    let misfit = known.as_ref().zip(wanted.noise).map(|(known, noise)| known.residual / noise);
    Ok(FoundModuli { all, weak, misfit })
}
