//! Springs by a published formula: `objective = "van-gelder"` and the others of [`crate::fit::published::Method`].

mod entry;
mod fitting;
mod outcome;
mod record;

pub use entry::PublishedEntry;
pub use outcome::PublishedOutcome;
pub use record::PublishedRecord;
