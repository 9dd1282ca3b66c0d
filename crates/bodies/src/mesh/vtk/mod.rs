//! The unstructured grids of VTK: reads `.vtu` and legacy `.vtk`, writes `.vtu`.

mod cells;
mod document;
mod legacy;
mod piece;
mod scalar_type;
mod storage;
mod write;
mod xml;
mod xml_tag;

pub use legacy::parse as parse_legacy;
pub(super) use legacy::piece as legacy_piece;
pub(super) use piece::{DataArray, Piece};
pub use write::{Array, Grid, write};
pub use xml::parse as parse_xml;
pub(super) use xml::pieces as xml_pieces;
