//! Upper bounds of the counts that an input may ask for.
//!
//! A larger count is almost certainly a typing error, and the work would take days. Each bound is far above what the
//! measured uses need.

use crate::error::{Error, ErrorKind, Result};

/// Iterations of Newton's method, or of a fit to the whole object. A run that needs as many does not converge.
pub const ITERATIONS: u64 = 100_000;
/// Iterations of a search by a general optimiser, for each element. A population-based search stores one state per
/// particle, not per iteration, so that time is the only limit.
pub const SEARCH_ITERATIONS: u64 = 1_000_000_000;
/// Starts from which the parameters of a spring law are searched, for each element.
pub const STARTS: u64 = 10_000;
/// Deformed shapes that are sampled for each element. Each is stored during the fit.
pub const SHAPES: u64 = 10_000_000;
/// Random shapes of an element on which fits are compared. Each is fitted by every fit, which takes up to milliseconds.
pub const RANDOM_SHAPES: u64 = 1_000_000;
/// Steps in which a load is applied. Each takes a factor of the stiffness at least.
pub const LOAD_STEPS: u64 = 100_000;
/// Natural frequencies of a model that are computed. Each has a shape in memory: 2.4 GB for 100 000 points in space.
pub const MODES: u64 = 1_000;
/// Time steps of a motion. Steps are not kept, so that time is the only limit.
pub const STEPS: u64 = 1_000_000_000;
/// Rows of the table of a motion over time. The table is kept in memory.
pub const STATES: u64 = 1_000_000;
/// Studies of a sweep. Each has a row of its own.
pub const STUDIES: u64 = 1_000_000;
/// Cells of a generated mesh, and its nodes. A finer mesh has to come from a file.
pub const CELLS: u64 = 2_000_000;

/// Checks that a count is from `least` to `most`.
///
/// # Errors
/// The count is outside these bounds. The error names `key`; its kind is `Limit` if the count is too large.
pub fn check_count(key: &str, count: u64, least: u64, most: u64) -> Result<()> {
    if (least..=most).contains(&count) {
        return Ok(());
    }
    let error = Error::expected(key, format!("a number from {least} to {most}"), count);
    Err(if count > most { error.of_kind(ErrorKind::Limit) } else { error })
}
