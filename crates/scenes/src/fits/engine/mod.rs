//! Constants for an engine that ends its sweeps early: the key `engine` of a `[[fit]]`.
//!
//! Theory: page *Networks in engines* of the book.

mod entry;
mod outcome;

pub use entry::EngineEntry;
pub(super) use entry::EngineOrName;
pub use outcome::{EngineErrors, EngineLimit, EngineOutcome, EngineVibration, FitLimit};
