//! Networks that are the finite element: `objective = "exact"`.

mod entry;
mod fitting;
mod outcome;
mod positive;
mod recipe;
mod record;

pub use entry::ExactEntry;
pub use outcome::ExactOutcome;
pub use positive::PositiveRecord;
pub use recipe::ExactRecipe;
pub use record::ExactRecord;
