//! Springs from the displacements of the whole object: `objective = "whole"`.
//!
//! Theory: page *Whole-object fits* of the book.

mod body;
mod entry;
mod fitting;
mod held_out;
mod objects;
mod outcome;
mod recipe;
mod record;
mod targets;

pub use body::WholeBody;
pub use entry::{WholeEntry, starts};
pub use held_out::{HeldOut, ModelError};
pub use outcome::{FittedLoad, FoundModulus, WholeOutcome};
pub use recipe::{LoadSelection, RESERVED, Sharing, Start, ValidationRecipe, WholeRecipe};
pub use record::{WholeOutcomeRecord, WholeRecord};
