//! Networks from the energy of the finite element: `objective = "exact"`. With the usual keys they are equal to it; with other domains for μ or λ
//! they are softer.
//!
//! Theory: page *Exact networks and patches* of the book.

mod entry;
mod fitting;
mod outcome;
mod positive;
mod recipe;
mod record;

pub use entry::{ExactEntry, without_groups};
pub use outcome::ExactOutcome;
pub use recipe::{ExactRecipe, spring_words};
pub use record::ExactRecord;
