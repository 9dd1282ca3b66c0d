//! Whether whole-object fits from several starts come to the same.

use crate::number::or_nan;
use crate::order::grouped;
use crate::study::{FitOutcome, Outcome, Start, ValidationRecipe, WholeRecipe};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Whether whole-object fits from several starts give the same errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Agreement {
    /// These fits differ only in their start.
    pub fits: Vec<String>,
    /// The errors differ most under this held-out load.
    pub load: String,
    /// The errors differ by this share of the least one, or of 0.1 % where that is less; it is null where a network does not stand.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub difference: f64,
    /// The errors differ by no more than a fifth.
    pub agree: bool,
}

/// An error e_rms below this, in percent, is taken as zero: the ratio of two such errors would tell nothing.
const NONE: f64 = 0.1;

/// Up to this share they are said to agree.
// Starts agree within a tenth on bodies of tetrahedra (`docs/src/studies/whole-object.md`). With twice that one of them has found another
// optimum.
const SAME: f64 = 0.2;

/// The fits of a scene from several starts.
pub fn agreements(outcome: &Outcome) -> Vec<Agreement> {
    let families = grouped(outcome.fits.iter().filter_map(|fit| {
        let recipe = WholeRecipe { start: Start::Equal, ..fit.fit.recipe.whole()?.clone() };
        Some(((recipe, &fit.fit.springs), fit))
    }));
    let several = families.iter().filter(|(_, fits)| fits.len() > 1);
    several.filter_map(|((recipe, _), fits)| agreement(recipe, fits)).collect()
}

fn agreement(recipe: &WholeRecipe, fits: &[&FitOutcome]) -> Option<Agreement> {
    let validated = match &recipe.validation {
        ValidationRecipe::Loads(loads) => &loads.names[..],
        ValidationRecipe::LeaveOneOut | ValidationRecipe::Discrepancy | ValidationRecipe::None => &[],
    };
    let difference = |l: usize| {
        let errors = fits.iter().map(|fit| fit.loads[l].error.map_or(f64::INFINITY, |e| e.rms));
        let (least, largest) = errors.fold((f64::INFINITY, 0.0f64), |(a, b), e| (a.min(e), b.max(e)));
        let share = if largest.is_finite() { (largest - least) / least.max(NONE) } else { f64::INFINITY };
        (fits[0].loads[l].name.clone(), share)
    };
    let held_out = |l: &usize| {
        let name = &fits[0].loads[*l].name;
        !recipe.loads.names.contains(name) && !validated.contains(name)
    };
    let differences = (0..fits[0].loads.len()).filter(held_out).map(difference);
    let (load, difference) = differences.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let fits = fits.iter().map(|fit| fit.fit.name.clone()).collect();
    Some(Agreement { fits, load, difference, agree: difference <= SAME })
}
