//! The settings of an exact network in a report.

use super::recipe::ExactRecipe;
use crate::fit::ExactEnergy;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings of an exact network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "(exact)")]
pub struct ExactRecord {
    /// The objective is `exact`.
    pub objective: String,
    /// The network has this energy. It is null if it is that of the material's law, or the stable neo-Hookean one without a law.
    pub energy: Option<String>,
    /// Shear springs average the deformation over `cells`, or over the domains of `edges`.
    pub shear: String,
    /// Volume springs measure the content of quadrature `points`, `cells` or `patches`.
    pub volume: String,
    /// The second invariant has this share, if the energy has one.
    pub share: Option<f64>,
    /// No constant may be negative.
    pub nonnegative: bool,
    /// Springs across the sides of cells may be added.
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
                Some(ExactEnergy::StableNeoHookean | ExactEnergy::NeoHookean | ExactEnergy::StVenantKirchhoff)
                | None => None,
            },
        }
    }
}
