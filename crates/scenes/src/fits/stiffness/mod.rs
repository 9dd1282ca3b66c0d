//! Springs from the stiffness at rest: `objective = "frobenius"`, `"spectral"` and the others of
//! [`crate::fit::Objective`].
//!
//! Theory: pages *Least squares*, *The 2-norm*, *The divergence* and *Modal weights* of the book.

mod entry;
mod fitting;
mod outcome;
mod record;
mod tension;

pub use entry::StiffnessEntry;
pub use fitting::fit_at_rest;
pub use outcome::StiffnessOutcome;
pub use record::StiffnessRecord;
pub use tension::TensionOutcome;
