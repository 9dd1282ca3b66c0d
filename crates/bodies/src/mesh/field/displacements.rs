//! Displacements of a mesh's points.

use super::reading::Reading;
use super::{grid, table};
use crate::error::{Error, ErrorKind, Result};
use crate::file::{ending, read, read_text};
use crate::mesh::mesh::Mesh;
use crate::mesh::vtk;
use crate::range;
use std::path::Path;

/// Displacements of some points of a mesh, as measured or simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// `[points · dimension]`, m; `None` where the file says nothing of this direction of the point.
    pub displacements: Vec<Option<f64>>,
}

impl Field {
    /// Reads `.csv`, `.vtu` or `.vtk`, told apart by the ending. Lengths in the file, positions as well as
    /// displacements, are multiplied by `scale`, metres per unit of the file.
    ///
    /// A table has a header with the names of its columns, between commas, semicolons or tabs. `x`, `y` (and `z`) are
    /// the position of the point at rest, or `point` is its number in the mesh, from 0; where both are there they must
    /// agree. `ux`, `uy`, `uz` are the displacement, or `x_deformed`, `y_deformed`, `z_deformed` the position after it;
    /// some directions may be missing. Capitals, other columns, blank lines and those that begin with `#` do not
    /// count. An empty cell or `nan` is not measured.
    ///
    /// A grid has an array of its points called `displacement`, `displacements`, `u` or `disp`, in capitals or not, or
    /// else a single one of three real components that is not called `normals`; `nan` is not measured.
    ///
    /// Positions are those of the nearest point of the mesh, within 1e-6 of the mesh's largest extent. On a plane mesh
    /// the third direction does not count.
    ///
    /// # Errors
    /// The file is missing, of another kind, damaged or cut short, lacks such columns or such an array, has a value
    /// that is no finite number, names a point that the mesh does not have or one point twice, or measures nothing. A
    /// grid may name a point twice with the same displacement, as its pieces do, and have points of no cell that the
    /// mesh does not have.
    pub fn read(path: &Path, mesh: &Mesh, scale: f64) -> Result<Field> {
        Field::read_named(path, mesh, scale, None)
    }

    /// As [`Field::read`], but takes the displacements called `array`: this array of the points of a grid, or the
    /// columns `array_x`, `array_y`, `array_z` of a table.
    ///
    /// # Errors
    /// As there.
    pub fn read_named(path: &Path, mesh: &Mesh, scale: f64, array: Option<&str>) -> Result<Field> {
        range::positive("scale", scale, "metres per unit of the file")?;
        let mut reading = Reading::new(mesh, scale);
        let done = match ending(path).as_str() {
            "csv" => table::read(&read_text(path)?, array, &mut reading),
            "vtu" => vtk::xml_pieces(&read(path)?).and_then(|pieces| grid::read(pieces, array, &mut reading)),
            "vtk" => vtk::legacy_piece(&read(path)?).and_then(|piece| grid::read(vec![piece], array, &mut reading)),
            _ => Err(Error::new("expected displacements ending in .csv, .vtu or .vtk").of_kind(ErrorKind::Unsupported)),
        };
        let displacements = done.and_then(|()| reading.displacements()).map_err(|e| e.in_file(path))?;
        Ok(Field { displacements })
    }
}
