//! The settings of an exact network in a report.

use super::recipe::ExactRecipe;
use crate::fit::ExactEnergy;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings of an exact network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExactRecord {
    /// The objective, `exact`.
    pub objective: String,
    /// The energy. Null: that of the material's law, or the stable neo-Hookean one if there is no law.
    pub energy: Option<String>,
    /// The domains over which shear springs average the deformation: `cells` or `edges`.
    pub shear: String,
    /// The contents that volume springs measure: `points`, `cells` or `patches`.
    pub volume: String,
    /// The share of the second invariant, if the energy has one.
    pub share: Option<f64>,
    /// Whether no constant may be negative.
    pub nonnegative: bool,
    /// Whether springs across the sides of cells may be added.
    pub across: bool,
}

impl ExactRecord {
    pub(super) fn of(recipe: &ExactRecipe) -> ExactRecord {
        ExactRecord {
            objective: "exact".into(),
            energy: recipe.energy.as_ref().map(ExactEnergy::name).map(String::from),
            shear: recipe.shear.name().into(),
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
