//! Networks that are the finite element: `objective = "exact"`.

mod entry;
mod fitting;
mod outcome;
mod recipe;
mod record;

pub use entry::ExactEntry;
pub use outcome::ExactOutcome;
pub use recipe::ExactRecipe;
pub use record::ExactRecord;
