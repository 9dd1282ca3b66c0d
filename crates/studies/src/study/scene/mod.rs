//! The scene file: its entries, and the checks that can be made before the mesh is read.

mod anisotropic;
mod constants;
mod distribution;
mod document;
mod elements;
mod entry;
mod gauge;
mod input;
mod laws;
mod lists;
mod load;
mod material;
mod motion;
mod motion_recipe;
mod output;
mod part;
mod places;
mod reference;
mod regions;
mod setting;
mod source;
mod value;
mod variants;

pub use document::Scene;
pub(in crate::study) use elements::load_element;
pub use elements::load_elements;
pub use entry::scene_schema;
pub use gauge::Gauge;
pub use input::{BoxEntry, DiscEntry, FillEntry, MeshInput, check_unit};
pub use load::{LoadCase, LoadKind, MeasuredEntry};
pub use motion_recipe::{AppliedForce, DampingRecipe, ForcePrecision, MotionRecipe, PrescribedMotion, motion_title};
pub use output::Output;
pub use part::Part;
pub use reference::ReferenceEntry;
pub use setting::Setting;
