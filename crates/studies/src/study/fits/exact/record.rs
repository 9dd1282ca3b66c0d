//! The settings of an exact network, as a report has them.

use super::recipe::ExactRecipe;
use crate::fit::ExactEnergy;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExactRecord {
    pub objective: String,
    /// Null: that of the material's law, or the stable neo-Hookean one where it has none.
    pub energy: Option<String>,
    pub volume: String,
    /// Of the second invariant, where the energy has one.
    pub share: Option<f64>,
    pub nonnegative: bool,
    pub across: bool,
}

impl ExactRecord {
    pub(super) fn of(recipe: &ExactRecipe) -> ExactRecord {
        ExactRecord {
            objective: "exact".into(),
            energy: recipe.energy.as_ref().map(ExactEnergy::name).map(String::from),
            volume: recipe.volume.name().into(),
            nonnegative: recipe.positive.is_some(),
            across: recipe.positive.is_some_and(|positive| positive.across),
            share: match recipe.energy {
                Some(ExactEnergy::StableMooneyRivlin { share }) => Some(share),
                Some(ExactEnergy::StableNeoHookean | ExactEnergy::NeoHookean) | None => None,
            },
        }
    }
}
