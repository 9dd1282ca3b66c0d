//! The kinds of fits, one folder for each: what a scene file says of it, how it is computed, and what is reported.

mod engine;
mod entry;
mod exact;
mod facts;
mod fitted;
mod kind;
mod named;
mod published;
mod recipe;
mod record;
mod sampled;
mod schema;
mod stiffness;
mod whole;

pub use engine::{EngineEntry, EngineErrors, EngineLimit, EngineOutcome, EngineVibration, FitLimit};
pub use entry::FitEntry;
pub use exact::{ExactOutcome, ExactRecipe, ExactRecord};
pub use facts::SceneFacts;
pub use fitted::{Fitted, FittedKind};
pub use kind::{CellMethod, FitKind, Reference, Task};
pub use named::NamedFit;
pub use published::{PublishedOutcome, PublishedRecord};
pub use recipe::Recipe;
pub use record::KindRecord;
pub use sampled::{
    FamilyOutcome, FitFunctions, ForceRecipe, SampledOutcome, SampledRecipe, SampledRecord, SetStates, ShapeOrigin,
    ShapesRecord, StartOutcome, WorstShape, law_at,
};
pub use schema::fit_schema;
pub use stiffness::{StiffnessOutcome, StiffnessRecord, TensionOutcome};
pub use whole::{
    FittedLoad, FittedMasses, FoundModuli, FoundModulus, HeldOut, LoadSelection, MadeLoads, ModelError,
    ModelFrequencies, ModuliSearch, RESERVED, ScaledLoad, Sharing, Start, SupportFrequencies, SupportPart,
    ValidationRecipe, WholeBody, WholeOutcome, WholeRecipe, WholeRecord, WorseLoad, held_conditions,
};
