//! The moduli that a whole-object fit has found, with their intervals.

use super::outcome::FoundModulus;
use super::recipe::WholeRecipe;
use crate::error::Result;
use crate::whole::{Determination, Displacements, ModuliSharing, Object, Wanted, WholeFit};

/// Deviations on either side that hold 95 % of a normal distribution.
const NINETY_FIVE: f64 = 1.96;

/// The moduli of the body or its regions with their intervals, if these are the unknowns.
pub(super) fn found_moduli(
    recipe: &WholeRecipe,
    object: &Object,
    wanted: &Wanted,
    found: &WholeFit,
) -> Result<Vec<FoundModulus>> {
    let sharing = recipe.unknowns.moduli().filter(|sharing| *sharing != ModuliSharing::Element && found.stands);
    let Some(sharing) = sharing else { return Ok(Vec::new()) };
    let names = object.modulus_names(sharing);
    let factors = object.modulus_factors(&found.theta).unwrap_or_default();
    let problem = Displacements::new(object, wanted.trained.iter().collect(), None)?;
    // Too many unknowns are not tried, and fewer displacements than unknowns determine none of them.
    let deviations = Determination::of(&problem, &found.theta).ok();
    let modulus = |(p, (name, factor)): (usize, (String, f64))| {
        let deviation = deviations.as_ref().and_then(|known| known.deviations[p]);
        let ends = |d: f64| [factor * (-NINETY_FIVE * d).exp(), factor * (NINETY_FIVE * d).exp()];
        FoundModulus { name, factor, interval: deviation.map(ends) }
    };
    Ok(names.into_iter().zip(factors).enumerate().map(modulus).collect())
}
