//! The grids of VTK: reads XML and legacy files of every kind of grid, writes `.vtu`.

mod cells;
mod compression;
mod division;
mod document;
mod grid_kind;
mod image;
mod lattice;
mod lattice_pieces;
mod legacy;
mod legacy_cells;
mod legacy_dataset;
mod piece;
mod polydata;
mod scalar_type;
mod storage;
mod write;
mod xml;
mod xml_tag;

pub(super) use image::Image;
pub(super) use lattice::Lattice;
pub use legacy::parse as parse_legacy;
pub(super) use legacy::piece as legacy_piece;
pub(super) use piece::{DataArray, Labels, Piece, mesh};
pub(super) use scalar_type::ScalarType;
pub use write::{Array, Grid, write};
pub use xml::parse as parse_xml;
pub(super) use xml::pieces as xml_pieces;
