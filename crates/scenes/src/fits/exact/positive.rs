//! What a network without negative springs has to say to its reader.

use crate::positive::{PositiveOutcome, Route};

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
