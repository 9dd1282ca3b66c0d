//! Measured or simulated displacements of some points of a mesh.

use super::reading::Reading;
use super::{grid, table};
use crate::error::{Error, ErrorKind, Result};
use crate::file::{ending, read, read_text};
use crate::mesh::mesh::Mesh;
use crate::mesh::vtk;
use crate::range;
use std::path::Path;

/// Displacements of some points of a mesh, measured or simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// The displacements, `[points · dimension]`, m; `None` if the file has no value for this direction of the point.
    pub displacements: Vec<Option<f64>>,
}

impl Field {
    /// Reads `.csv`, `.vtu` or `.vtk`, according to the extension. Lengths in the file, positions as well as
    /// displacements, are multiplied by `scale`, in metres per unit of the file.
    ///
    /// A table has a header with the names of its columns, separated by commas, semicolons or tabs. `x`, `y` (and `z`)
    /// are the position of the point at rest, or `point` is its number in the mesh, from 0; if both are given they must
    /// agree. `ux`, `uy`, `uz` are the displacement, or `x_deformed`, `y_deformed`, `z_deformed` the position after it;
    /// directions may be missing. Upper case is read as lower case; other columns, blank lines and lines that begin
    /// with `#` are ignored. An empty cell or `nan` means not measured.
    ///
    /// A grid has a point array called `displacement`, `displacements`, `u` or `disp`, in upper or lower case, or else
    /// exactly one array of three real components that is not called `normals`; `nan` means not measured.
    ///
    /// Positions are matched to the nearest point of the mesh, within 1e-6 of the largest extent of the mesh. On a
    /// plane mesh the third direction is ignored.
    ///
    /// # Errors
    /// The file is missing, of another kind, damaged or cut short; it lacks such columns or such an array; it has a
    /// value that is not a finite number; it names a point that the mesh does not have, or one point twice; or it
    /// measures nothing. A grid may name a point twice with the same displacement, as its pieces do, and may have
    /// points that belong to no cell and are not in the mesh.
    pub fn read(path: &Path, mesh: &Mesh, scale: f64) -> Result<Field> {
        Field::read_named(path, mesh, scale, None)
    }

    /// Reads a file as [`Field::read`] does, with the displacements called `array`: this point array of a grid, or the columns `array_x`,
    /// `array_y`, `array_z` of a table.
    ///
    /// # Errors
    /// Those of [`Field::read`].
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
