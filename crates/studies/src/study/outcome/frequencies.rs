//! Natural frequencies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The lowest natural frequencies of one model, with masses lumped at its points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct FrequencyOutcome {
    /// The model is the fit of this name, or `finite elements`.
    pub name: String,
    /// The natural frequencies are in Hz, ascending.
    pub frequencies: Option<Vec<f64>>,
    /// This number of rigid motions is left out, which `[[fix]]` leaves free.
    #[serde(rename = "rigid_motions")]
    pub rigid: usize,
    /// A sentence says why there are no frequencies; it is null if there are.
    pub reason: Option<String>,
}
