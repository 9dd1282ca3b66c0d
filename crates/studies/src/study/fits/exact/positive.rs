//! The record of a network without negative springs in a report.

use crate::positive::{PositiveOutcome, Route};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The difference from the exact network. Errors of energies are relative to the exact ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PositiveRecord {
    /// The network is `unchanged`, or `springs`, springs `across` sides or `tensions` were changed.
    pub route: String,
    /// The exact network has this number of negative springs.
    pub negative_springs: usize,
    /// This number of springs of the exact network was removed.
    pub dropped_springs: usize,
    /// This number of springs was added across the sides of cells.
    pub springs_across: usize,
    /// The tension of a spring on content is between these multiples of the exact one.
    pub tensions: [f64; 2],
    /// The energy of a homogeneous strain has at most this relative error.
    pub affine_energy_error: f64,
    /// The energies of this number of modes were to be kept.
    pub modes: usize,
    /// The energy of a mode has a relative error between these two.
    pub mode_energy_errors: [f64; 2],
    /// The largest force on a point at rest is this share of the largest force of a spring.
    pub rest_force: f64,
    /// The quadratic programme took this number of iterations.
    pub iterations: u32,
}

impl PositiveRecord {
    /// The record of this outcome.
    pub fn of(outcome: &PositiveOutcome) -> PositiveRecord {
        PositiveRecord {
            route: outcome.route.name().into(),
            negative_springs: outcome.negative,
            dropped_springs: outcome.dropped,
            springs_across: outcome.across,
            tensions: outcome.tensions,
            affine_energy_error: outcome.affine,
            modes: outcome.modes,
            mode_energy_errors: outcome.mode_errors,
            rest_force: outcome.rest_force,
            iterations: outcome.iterations,
        }
    }
}

/// A note for the reader.
pub(super) fn positive_note(outcome: &PositiveOutcome) -> String {
    let PositiveOutcome { negative, modes, mode_errors: [low, high], .. } = outcome;
    let affine = 100.0 * outcome.affine;
    let homogeneous = match outcome.route {
        Route::Unchanged if *negative == 0 => return "the exact network has no negative springs".into(),
        Route::Unchanged => return format!("{negative} negative springs of the exact network were rounding"),
        Route::Springs => "equal under homogeneous deformations".to_string(),
        Route::Across => format!("equal under homogeneous deformations, with {} springs across sides", outcome.across),
        Route::Tensions => {
            let [least, largest] = outcome.tensions;
            let across =
                if outcome.across > 0 { format!(", {} springs across sides", outcome.across) } else { "".into() };
            format!(
                "energies of homogeneous strains within {affine:.1e} %, springs on content with {least:.2} to {largest:.2} times \
                 their tension{across}"
            )
        }
    };
    let modes = match modes {
        0 => String::new(),
        modes => format!("; energies of the {modes} lowest free modes {:+.2} to {:+.2} %", 100.0 * low, 100.0 * high),
    };
    format!(
        "this is the network without negative springs that is nearest to the exact network, which has {negative} of them: {homogeneous}{modes}"
    )
}
