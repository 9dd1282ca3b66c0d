//! Input files of Abaqus and CalculiX (`.inp`): one body of numbered nodes and elements, with its sets and surfaces.

mod deck;
mod keyword;
mod placement;
mod sets;
mod types;

pub use deck::parse;
