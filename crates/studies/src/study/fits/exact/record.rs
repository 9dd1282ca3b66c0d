//! The settings of an exact network, as a report has them.

use super::recipe::ExactRecipe;
use crate::fit::ExactEnergy;
use serde::{Deserialize, Serialize};

/// The settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExactRecord {
    pub objective: String,
    /// Null: that of the material's law, or the stable neo-Hookean one where it has none.
    pub energy: Option<String>,
    pub volume: String,
}

impl ExactRecord {
    pub(super) fn of(recipe: &ExactRecipe) -> ExactRecord {
        ExactRecord {
            objective: "exact".into(),
            energy: recipe.energy.as_ref().map(ExactEnergy::name).map(String::from),
            volume: recipe.volume.name().into(),
        }
    }
}
