//! Displacements of a mesh's points from the files of measurements and of other programs.

mod grid;
mod locator;
mod table;

use super::Mesh;
use crate::error::{Error, Result};
use crate::file::{ending, read, read_text};
use locator::Locator;
use std::path::Path;

/// Names of the directions in columns.
const AXES: [&str; 3] = ["x", "y", "z"];

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
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(Error::expected("scale", "a positive number", scale));
        }
        let mut reading = Reading::new(mesh, scale);
        let done = match ending(path).as_str() {
            "csv" => table::read(&read_text(path)?, array, &mut reading),
            ending @ ("vtu" | "vtk") => grid::read(&read(path)?, ending, array, &mut reading),
            _ => Err(Error::new("expected displacements ending in .csv, .vtu or .vtk")),
        };
        done.and_then(|()| reading.field()).map_err(|e| e.in_file(path))
    }
}

/// What has been read of a field so far.
struct Reading<'a> {
    mesh: &'a Mesh,
    scale: f64,
    locator: Locator,
    displacements: Vec<Option<f64>>,
    /// The place in the file that named each point.
    places: Vec<Option<usize>>,
}

impl Reading<'_> {
    fn new(mesh: &Mesh, scale: f64) -> Reading<'_> {
        let places = vec![None; mesh.point_count()];
        Reading { mesh, scale, locator: Locator::new(mesh), displacements: vec![None; mesh.points.len()], places }
    }

    /// A length of the file in m; `None` for what is not measured.
    fn length(&self, value: f64) -> Result<Option<f64>> {
        let length = value * self.scale;
        if length.is_infinite() {
            return Err(Error::new(format!(
                "expected a finite length, found {value:?} times the scale {:?}",
                self.scale
            )));
        }
        Ok((!length.is_nan()).then_some(length))
    }

    /// The point of the mesh at a position in m; where several are, the one of them whose number is `preferred`.
    ///
    /// # Errors
    /// None is there, or several of which none is preferred.
    fn point_at(&self, position: &[f64], preferred: Option<usize>) -> Result<usize> {
        let found = self.locator.at(position);
        match (&found[..], preferred) {
            (&[point], _) => Ok(point),
            (&[], _) => {
                let (point, distance) = self.locator.nearest(position);
                let hint = format!("is the scale {:?} m per unit of the file right?", self.scale);
                let nearest = format!("{distance:?} m from the nearest, point {}", point);
                let found = format!("{} m, {nearest}; {hint}", listed(position));
                Err(Error::expected("position", "that of a point of the mesh", found))
            }
            (_, Some(point)) if found.contains(&point) => Ok(point),
            (&[first, second, ..], _) => {
                let found = format!("points {} and {}, both at {} m", first, second, listed(position));
                Err(Error::expected("position", "that of one point of the mesh", found))
            }
        }
    }

    /// Notes that this place of the file names the point, and returns the place that did so before.
    fn claim(&mut self, point: usize, place: usize) -> Option<usize> {
        let before = self.places[point];
        self.places[point] = before.or(Some(place));
        before
    }

    fn field(self) -> Result<Field> {
        if self.displacements.iter().all(Option::is_none) {
            return Err(Error::new("the file measures no displacement of any point"));
        }
        Ok(Field { displacements: self.displacements })
    }
}

/// Coordinates in parentheses.
fn listed(position: &[f64]) -> String {
    let numbers: Vec<_> = position.iter().map(|x| format!("{x:?}")).collect();
    format!("({})", numbers.join(", "))
}
