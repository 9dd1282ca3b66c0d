//! Natural frequencies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The lowest natural frequencies of one model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct FrequencyOutcome {
    /// The model is the fit of this name, `finite elements`, or `quadratic elements` where the cells of the mesh lock.
    pub name: String,
    /// The natural frequencies with masses lumped at the points are in Hz, ascending.
    pub frequencies: Option<Vec<f64>>,
    /// The natural frequencies with consistent masses, the matrix of the shape functions of the cells, are in Hz, ascending. Those of the
    /// quadratic elements, or else of the finite elements, are what the others are compared with.
    pub consistent: Option<Vec<f64>>,
    /// This number of rigid motions is left out, which `[[fix]]` leaves free.
    #[serde(rename = "rigid_motions")]
    pub rigid: usize,
    /// A sentence says why there are no frequencies, or none with consistent masses; it is null if there are both.
    pub reason: Option<String>,
}
