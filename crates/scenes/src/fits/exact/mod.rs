//! Networks that are equal to the finite element: `objective = "exact"`.
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
