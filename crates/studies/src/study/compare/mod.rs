//! Comparisons: fits on elements, on shapes, at large deformation and in scenes, with honest time.

mod axes;
mod cells;
mod entry;
mod plan;
mod record;
mod run;
mod sets;
mod usual;

pub use cells::{MethodOutcome, compare_element, measure_recipes};
pub use entry::compare_schema;
pub use plan::{Case, Comparing, is_comparison};
pub use record::{CaseRecord, MethodRecord};
pub use usual::{compare_scene, compared};
