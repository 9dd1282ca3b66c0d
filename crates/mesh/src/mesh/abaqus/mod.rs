//! Input files of Abaqus and CalculiX (`.inp`): numbered nodes and elements of one body, with its sets and surfaces.

mod data;
mod deck;
mod generation_geometry;
mod generation_keywords;
mod include;
mod keyword;
mod model;
mod placement;
mod sections;
mod sets;
mod surfaces;
mod types;

pub use deck::parse;
pub(super) use include::inclusion;
