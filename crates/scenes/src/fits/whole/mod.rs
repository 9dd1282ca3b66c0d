//! Springs from the displacements of the whole object: `objective = "whole"`.
//!
//! Theory: page *Whole-object fits* of the book.

mod body;
mod corrected;
mod engine;
mod entry;
mod evidence;
mod finer_steps;
mod fitting;
mod found_moduli;
mod frequencies;
mod held;
mod held_out;
mod identity;
mod made_loads;
mod moduli;
mod notes;
mod objects;
mod outcome;
mod recipe;
mod record;
mod stretched;
mod targets;

pub use body::WholeBody;
pub use entry::{WholeEntry, starts};
pub use held::held_conditions;
pub use made_loads::{MadeLoads, ScaledLoad};
pub use moduli::{FoundModuli, FoundModulus, ModuliSearch};
pub use outcome::{
    FittedLoad, FittedMasses, HeldOut, ModelError, ModelFrequencies, SupportFrequencies, SupportPart, WholeOutcome,
    WorseLoad,
};
pub use recipe::{LoadSelection, RESERVED, Sharing, Start, ValidationRecipe, WholeRecipe};
pub use record::WholeRecord;
