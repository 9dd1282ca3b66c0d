//! How many cells a fill may have.

use crate::bound;
use crate::error::{Error, ErrorKind};

pub(super) const MOST_CELLS: usize = bound::CELLS as usize;

/// That cells turned out to be more than there may be.
pub(super) fn too_many() -> Error {
    Error::expected("cell", format!("at most {MOST_CELLS} cells: a larger cell"), "more").of_kind(ErrorKind::Limit)
}
