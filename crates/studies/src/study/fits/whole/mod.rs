//! Springs from the displacements of the whole object: `objective = "whole"`.
//!
//! Theory: page *Whole-object fits* of the book.

mod body;
mod entry;
mod fitting;
mod outcome;
mod recipe;
mod record;

pub use body::WholeBody;
pub use entry::{WholeEntry, starts};
pub use outcome::{FittedLoad, WholeOutcome};
pub use recipe::{LoadSelection, RESERVED, Sharing, Start, ValidationRecipe, WholeRecipe};
pub use record::{WholeOutcomeRecord, WholeRecord};
