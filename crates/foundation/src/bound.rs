//! How many of a thing an input may ask for. More is a slip of the pen, and would run for days.

use crate::error::{Error, ErrorKind, Result};

/// Of Newton's method, or of a fit to the whole object.
pub const ITERATIONS: u64 = 100_000;
/// Of a search by a general optimiser, for each element; a swarm keeps what each has found.
pub const SEARCH_ITERATIONS: u64 = 1_000_000_000;
/// From which a law's parameters are searched, for each element.
pub const STARTS: u64 = 10_000;
/// Sampled for each element.
pub const SHAPES: u64 = 10_000_000;
/// Made of an element to compare fits on.
pub const RANDOM_SHAPES: u64 = 1_000_000;
/// Steps of a load.
pub const LOAD_STEPS: u64 = 100_000;
/// Natural vibrations of a model.
pub const MODES: u64 = 1_000;
/// Steps of a motion.
pub const STEPS: u64 = 1_000_000_000;
/// Rows of a motion's table over time.
pub const STATES: u64 = 1_000_000;
/// Cells of a mesh that is generated, and its points.
pub const CELLS: u64 = 2_000_000;

/// That a count is from `least` to `most`.
///
/// # Errors
/// Names the key; of kind `Limit` where it is too large.
pub fn check_count(key: &str, count: u64, least: u64, most: u64) -> Result<()> {
    if (least..=most).contains(&count) {
        return Ok(());
    }
    let error = Error::expected(key, format!("a number from {least} to {most}"), count);
    Err(if count > most { error.of_kind(ErrorKind::Limit) } else { error })
}
