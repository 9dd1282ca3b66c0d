//! The moduli that a whole-object fit has found, with their intervals.

use super::outcome::FoundModulus;
use super::recipe::{Sharing, WholeRecipe};
use crate::error::Result;
use crate::whole::{Determination, Displacements, MOST_ESTIMATED, ModuliSharing, Object, Wanted, WholeFit};

/// Deviations on either side that hold 95 % of a normal distribution.
const NINETY_FIVE: f64 = 1.96;

/// The moduli of the body or its regions with their intervals, if these are the unknowns.
pub(super) fn found_moduli(
    recipe: &WholeRecipe,
    object: &Object,
    wanted: &Wanted,
    found: &WholeFit,
) -> Result<Vec<FoundModulus>> {
    let few = matches!(recipe.unknowns, Sharing::BodyModuli | Sharing::RegionModuli) && found.stands;
    let Some(factors) = object.modulus_factors(&found.theta).filter(|_| few) else { return Ok(Vec::new()) };
    let names = object.modulus_names(recipe.unknowns.moduli().unwrap_or(ModuliSharing::Body));
    let problem = Displacements::new(object, wanted.trained.iter().collect(), None)?;
    let known = factors.len() <= MOST_ESTIMATED;
    // Fewer displacements than unknowns determine none of them.
    let deviations = known.then(|| Determination::of(&problem, &found.theta).ok()).flatten();
    let modulus = |(p, (name, factor)): (usize, (String, f64))| {
        let deviation = deviations.as_ref().and_then(|known| known.deviations[p]);
        let ends = |d: f64| [factor * (-NINETY_FIVE * d).exp(), factor * (NINETY_FIVE * d).exp()];
        FoundModulus { name, factor, interval: deviation.map(ends) }
    };
    Ok(names.into_iter().zip(factors).enumerate().map(modulus).collect())
}
