//! Input files of Abaqus and CalculiX (`.inp`): numbered nodes and elements of one body, with its sets and surfaces.

mod data;
mod deck;
mod generation;
mod include;
mod keyword;
mod made;
mod model;
mod placement;
mod sections;
mod sets;
mod surfaces;
mod types;

pub use deck::parse;
pub(super) use include::inclusion;
