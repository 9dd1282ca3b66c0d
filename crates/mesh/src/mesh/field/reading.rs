//! The displacements that have been read so far, and the points to which they belong.

use super::locator::Locator;
use crate::error::{Error, Result};
use crate::mesh::mesh::Mesh;
use crate::range;

/// The names of the directions in columns.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// A field while it is read.
pub(super) struct Reading<'a> {
    pub mesh: &'a Mesh,
    scale: f64,
    pub locator: Locator,
    pub displacements: Vec<Option<f64>>,
    /// The place in the file that named each point.
    places: Vec<Option<usize>>,
}

impl Reading<'_> {
    pub fn new(mesh: &Mesh, scale: f64) -> Reading<'_> {
        let places = vec![None; mesh.point_count()];
        Reading { mesh, scale, locator: Locator::new(mesh), displacements: vec![None; mesh.points.len()], places }
    }

    /// The displacements that `read` reads, which may all be zero.
    ///
    /// # Errors
    /// Those of `read`.
    pub fn of(mesh: &Mesh, scale: f64, read: impl FnOnce(&mut Reading) -> Result<()>) -> Result<Vec<Option<f64>>> {
        let mut reading = Reading::new(mesh, scale);
        read(&mut reading)?;
        Ok(reading.displacements)
    }

    /// A length of the file in m; `None` if it is not measured.
    pub fn length(&self, value: f64) -> Result<Option<f64>> {
        let length = value * self.scale;
        // Infinite lengths are refused here too; NaN compares as false and means not measured.
        if length.abs() > range::LARGEST {
            let found = format!("found {value:?} times the scale {:?}", self.scale);
            return Err(Error::new(format!("expected a length of at most {:e} m, {found}", range::LARGEST)));
        }
        Ok((!length.is_nan()).then_some(length))
    }

    /// The point of the mesh at a position in m; of several points at one position the one with the number `preferred`.
    ///
    /// # Errors
    /// There is no point at the position, or there are several and none of them is the preferred one.
    pub fn point_at(&self, position: &[f64], preferred: Option<usize>) -> Result<usize> {
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

    /// Records that this place of the file names the point, and returns the place that named it before.
    pub fn claim(&mut self, point: usize, place: usize) -> Option<usize> {
        let before = self.places[point];
        self.places[point] = before.or(Some(place));
        before
    }

    /// The displacements, `[points · dimension]`, m.
    ///
    /// # Errors
    /// No displacement is given, or all are so small that their squares underflow.
    pub fn displacements(self) -> Result<Vec<Option<f64>>> {
        if self.displacements.iter().all(Option::is_none) {
            return Err(Error::new("the file measures no displacement of any point"));
        }
        range::largest("displacement", self.displacements.iter().flatten().copied(), "m")?;
        Ok(self.displacements)
    }
}

/// Coordinates in parentheses, for messages.
pub(super) fn listed(position: &[f64]) -> String {
    let numbers: Vec<_> = position.iter().map(|x| format!("{x:?}")).collect();
    format!("({})", numbers.join(", "))
}
