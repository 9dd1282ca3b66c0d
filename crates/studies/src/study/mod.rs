//! Whole studies: a scene from its file to the errors and times of each fit.

mod cases;
mod check;
mod checkpoint;
mod comparison;
mod course;
mod frequencies;
mod gauge;
mod large;
mod linear;
mod metrics;
mod moduli;
mod motion;
mod outcome;
mod paper;
mod raised;
mod random;
mod run;
mod scene;
mod stability;
mod stages;
mod stretches;
mod whole;

pub use check::{Inspection, Mark, Property, inspect};
pub use checkpoint::Controls;
pub use comparison::{MethodOutcome, compare_element, compare_scene, measure_recipes, random_shapes};
pub use frequencies::FrequencyOutcome;
pub use gauge::Reading;
pub use large::LargeBody;
pub use metrics::{DisplacementError, displacement_error};
pub use moduli::{EffectiveModuli, Lattice, moduli_of_body};
pub use motion::{ModelMotion, MotionEnding, MotionOutcome, Record};
pub use outcome::{FitOutcome, FittedLoad, Followed, LoadOutcome, MeasuredLoad, Outcome, SampledOutcome, WholeOutcome};
pub use paper::{
    Column, Index, Paper, PaperRow, PaperTable, Surface, file_stem, heading, run_paper, write_experiments,
};
pub use run::{Progress, Reference, fit_mesh, run, run_with};
pub use scene::{
    BoxEntry, DampingRecipe, DiscEntry, FitEntry, ForceRecipe, Judge, LoadCase, MeshInput, MotionRecipe, NamedFit,
    Output, Part, Pull, Push, Recipe, SampledRecipe, Scene, ShapesEntry, Start, WholeRecipe, integrator_name,
    load_elements,
};
pub use stability::{Family, StabilityOutcome, StabilityRow, Verdict, sweep, sweep_scene};
pub use stages::stages;
pub use stretches::{STRETCHES, SampledRun, StretchedFit, Stretches, compare_stretches};
pub use whole::WholeBody;
