//! Whether whole-object fits from several starts come to the same.

use crate::study::{FitOutcome, Outcome, Start, ValidationRecipe, WholeRecipe};

/// Whole-object fits that differ in their start alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// The names of the fits that are compared.
    pub fits: Vec<String>,
    /// The held-out load under which the errors differ most.
    pub load: String,
    /// By which share of the least of them, or of 0.1 % where that is less; infinite where a network does not stand.
    pub difference: f64,
}

/// %e_rms below which errors are as good as none.
const NONE: f64 = 0.1;

/// Up to this share they are said to agree.
pub const SAME: f64 = 0.2;

/// The fits of a scene from several starts.
pub fn agreements(outcome: &Outcome) -> Vec<Agreement> {
    let mut families: Vec<(WholeRecipe, Vec<&FitOutcome>)> = Vec::new();
    for fit in &outcome.fits {
        let Some(recipe) = fit.fit.recipe.whole() else { continue };
        let recipe = WholeRecipe { start: Start::Equal, ..recipe.clone() };
        match families.iter_mut().find(|(known, fits)| *known == recipe && fits[0].fit.springs == fit.fit.springs) {
            Some((_, fits)) => fits.push(fit),
            None => families.push((recipe, vec![fit])),
        }
    }
    families.iter().filter(|(_, fits)| fits.len() > 1).filter_map(|(recipe, fits)| agreement(recipe, fits)).collect()
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
    Some(Agreement { fits: fits.iter().map(|fit| fit.fit.name.clone()).collect(), load, difference })
}
