//! The difference between a network without negative springs and the exact network.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What was changed to remove negative springs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Route {
    /// Nothing: there are none.
    #[default]
    Unchanged,
    /// The constants of the springs between points of one cell.
    Springs,
    /// These constants, and springs across the sides of the cells.
    Across,
    /// The constants, and the tensions of the springs on content.
    Tensions,
}

crate::named!(Route {
    "unchanged" => Unchanged,
    "springs" => Springs,
    "across" => Across,
    "tensions" => Tensions,
});

/// The difference between the network and the exact one. Errors of energies are relative to the exact ones.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct PositiveOutcome {
    /// The route says what was changed: `unchanged`, `springs`, `across` or `tensions`.
    #[schemars(with = "String")]
    pub route: Route,
    /// The exact network has this number of negative springs.
    #[serde(rename = "negative_springs")]
    pub negative: usize,
    /// This number of springs of the exact network was removed.
    #[serde(rename = "dropped_springs")]
    pub dropped: usize,
    /// This number of springs was added across the sides of cells.
    #[serde(rename = "springs_across")]
    pub across: usize,
    /// The tension of a spring on content is between these multiples of the exact one.
    pub tensions: [f64; 2],
    /// The energy of a homogeneous strain has at most this relative error.
    #[serde(rename = "affine_energy_error")]
    pub affine: f64,
    /// The energies of this number of lowest modes, without supports, were to be kept.
    pub modes: usize,
    /// The energy of a mode has a relative error between these two.
    #[serde(rename = "mode_energy_errors")]
    pub mode_errors: [f64; 2],
    /// The largest force on a point at rest is this share of the largest force of a spring.
    pub rest_force: f64,
    /// The quadratic programme took this number of iterations.
    pub iterations: u32,
}
