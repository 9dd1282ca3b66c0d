//! VTK's unstructured grids: reads `.vtu` and legacy `.vtk`, writes `.vtu`.

mod blocks;
mod cells;
mod legacy;
mod legacy_type;
mod piece;
mod write;
mod xml;
mod xml_arrays;
mod xml_tag;

use super::source::MeshSource;
use crate::error::Result;
pub(super) use piece::{Piece, PointArray};
pub use write::{Array, Grid, write};

/// Reads an unstructured grid; `ending` tells XML, `vtu`, from the legacy format, `vtk`.
///
/// Cells of one type form one block where they agree in every array of whole numbers that has one number per cell and
/// at most 1000 different numbers; each such array gives the group `array=number`. Pixels and voxels become the
/// quadrangles and hexahedra they are.
///
/// # Errors
/// The file is of another kind, damaged or cut short, or has cells without a fixed shape such as polygons. A `.vtu`
/// whose data are appended raw or compressed otherwise than by zlib is not read either.
pub fn parse(bytes: &[u8], ending: &str) -> Result<MeshSource> {
    piece::mesh(pieces(bytes, ending)?)
}

/// The pieces of an unstructured grid as they stand in the file: cells unchecked, points perhaps not finite.
///
/// # Errors
/// As those of [`parse`], except for cells.
pub(super) fn pieces(bytes: &[u8], ending: &str) -> Result<Vec<Piece>> {
    if ending == "vtu" { xml::parse(bytes) } else { Ok(vec![legacy::parse(bytes)?]) }
}
