//! Springs from the forces of a hyperelastic element at sampled shapes: `objective = "sampled"`.
//!
//! Theory: page *Sampled fits* of the book.

mod entry;
mod fitting;
mod force;
mod functions;
mod origin;
mod outcome;
mod recipe;
mod record;
mod shapes_check;
mod shapes_entry;
mod values;

pub use entry::{SampledEntry, law_at};
pub use fitting::fit_shapes;
pub use force::ForceRecipe;
pub use functions::FitFunctions;
pub use origin::{SetStates, ShapeOrigin};
pub use outcome::{FamilyOutcome, SampledOutcome, StartOutcome, WorstShape};
pub use recipe::SampledRecipe;
pub use record::{SampledRecord, ShapesRecord};
