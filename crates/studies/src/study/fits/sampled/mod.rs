//! Springs from the forces of a hyperelastic element at sampled shapes: `objective = "sampled"`.
//!
//! Theory: page *Sampled fits* of the book.

mod entry;
mod fitting;
mod force;
mod functions;
mod outcome;
mod recipe;
mod record;

pub use entry::{SampledEntry, law_at};
pub use fitting::fit_shapes;
pub use force::ForceRecipe;
pub use functions::FitFunctions;
pub use outcome::SampledOutcome;
pub use recipe::SampledRecipe;
pub use record::SampledRecord;
