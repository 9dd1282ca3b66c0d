//! Whole studies: a scene from its file to the errors and times of each fit.

mod check;
mod comparison;
mod metrics;
mod moduli;
mod random;
mod run;
mod scene;

pub use check::{Inspection, Mark, Property, inspect};
pub use comparison::{MethodOutcome, compare_element, compare_scene, random_shapes};
pub use metrics::{DisplacementError, displacement_error};
pub use moduli::{EffectiveModuli, Lattice, moduli_of_body};
pub use run::{FitOutcome, LoadOutcome, Outcome, Progress, fit_mesh, run, stages};
pub use scene::{BoxEntry, LoadCase, MeshInput, NamedFit, Output, Part, Scene, load_elements};
