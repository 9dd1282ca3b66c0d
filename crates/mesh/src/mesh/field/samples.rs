//! Numbers at places, read from files: what a material is in a body.

use super::neighbours::Neighbours;
use super::raw::{Holder, Raw};
use super::{columns, pieces};
use crate::error::{Error, ErrorKind, Result};
use crate::file::{ending, read, read_text};
use crate::mesh::mesh::Mesh;
use crate::mesh::places::spatial;
use crate::mesh::vtk;
use crate::range;
use nalgebra::{DMatrix, DVector};
use std::path::Path;

/// How numbers between the places of samples are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// That of the nearest place.
    Nearest,
    /// That of the plane that fits the nearest places best, within the range of their numbers.
    Linear,
}

crate::named!(Interpolation { "nearest" => Nearest, "linear" => Linear });

/// Numbers at places in space.
pub struct Samples {
    holder: Holder,
    components: usize,
    /// `[places × components]`
    values: Vec<f64>,
    neighbours: Neighbours,
}

/// How many places a plane is fitted to, in each number of dimensions.
const FITTED: [usize; 4] = [1, 4, 8, 14];

impl Samples {
    /// Reads `.csv`, `.vtu` or `.vtk`, according to the extension. Positions are multiplied by `scale`, in metres per unit of the file.
    ///
    /// A table has a header with the columns `x`, `y` (and `z`) and that called `array`; without a name the only other column. A grid has
    /// a point or cell array called `array`; without a name the only one. Numbers of cells are at the mean of their nodes.
    ///
    /// `components` is how many numbers belong to each place: a table has them in columns `array_x`, `array_y`, `array_z`.
    ///
    /// # Errors
    /// The file is missing, of another kind, damaged or cut short; it lacks such columns or such an array; or it has a value that is
    /// not a finite number.
    pub fn read(path: &Path, array: Option<&str>, scale: f64, components: usize) -> Result<Samples> {
        range::positive("scale", scale, "metres per unit of the file")?;
        let raw = match ending(path).as_str() {
            "csv" => columns::read(&read_text(path)?, array, components),
            "vtu" => vtk::xml_pieces(&read(path)?).and_then(|all| pieces::read(&all, array, components)),
            "vtk" => vtk::legacy_piece(&read(path)?).and_then(|piece| pieces::read(&[piece], array, components)),
            _ => Err(Error::new("expected values ending in .csv, .vtu or .vtk").of_kind(ErrorKind::Unsupported)),
        };
        raw.and_then(|raw| Samples::of(raw, scale)).map_err(|e| e.in_file(path))
    }

    fn of(raw: Raw, scale: f64) -> Result<Samples> {
        let Raw { holder, mut places, components, values } = raw;
        if places.is_empty() {
            return Err(Error::new("expected at least one place with a value, found none"));
        }
        let name = |place: usize| match holder {
            Holder::Points => format!("points[{place}]"),
            Holder::Cells => format!("cells[{place}]"),
        };
        for (place, x) in places.iter_mut().enumerate() {
            x.iter_mut().for_each(|x| *x *= scale);
            if !x.iter().all(|x| x.abs() <= range::LARGEST) {
                return Err(Error::expected(name(place), "finite coordinates", format!("{x:?} m")));
            }
        }
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return Err(Error::expected(name(at / components), "a finite number", values[at]));
        }
        Ok(Samples { holder, components, values, neighbours: Neighbours::new(places) })
    }

    /// To what the numbers belong.
    pub fn holder(&self) -> Holder {
        self.holder
    }

    /// The distance of a position from the box around all places, m.
    pub fn outside(&self, x: &[f64]) -> f64 {
        self.neighbours.outside(&spatial(x))
    }

    /// The numbers at a position in a space of that many dimensions, `[components]`.
    pub fn at(&self, x: &[f64], interpolation: Interpolation) -> Vec<f64> {
        let position = spatial(x);
        match interpolation {
            Interpolation::Nearest => self.of_place(self.neighbours.nearest(&position, 1)[0].0).to_vec(),
            Interpolation::Linear => {
                let near = self.neighbours.nearest(&position, FITTED[x.len().min(3)]);
                (0..self.components).map(|k| self.plane(x, &near, k)).collect()
            }
        }
    }

    /// The numbers of each point of a mesh, `[points × components]`, if there is a place within `tolerance` of each, m.
    pub fn of_points(&self, mesh: &Mesh, tolerance: f64) -> Option<Vec<f64>> {
        let mut values = Vec::with_capacity(mesh.point_count() * self.components);
        for point in 0..mesh.point_count() {
            let (place, distance) = self.neighbours.nearest(&spatial(mesh.point(point)), 1)[0];
            if distance > tolerance {
                return None;
            }
            values.extend_from_slice(self.of_place(place));
        }
        Some(values)
    }

    fn of_place(&self, place: usize) -> &[f64] {
        &self.values[place * self.components..(place + 1) * self.components]
    }

    /// The value at `x` of the plane that has the least `Σ (f − f_i)²/d_i²`, d_i the distances, within the range of the f_i.
    fn plane(&self, x: &[f64], near: &[(usize, f64)], component: usize) -> f64 {
        let value = |place: usize| self.of_place(place)[component];
        let (first, least) = near[0];
        let farthest = near[near.len() - 1].1;
        if least <= 1e-9 * farthest || near.len() == 1 {
            return value(first);
        }
        let (low, high) = near.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (place, _)| {
            (low.min(value(*place)), high.max(value(*place)))
        });
        if low == high {
            return low;
        }
        let d = x.len();
        let row = |i: usize, k: usize| {
            let (place, distance) = near[i];
            let weight = least / distance;
            weight * if k == 0 { 1.0 } else { (self.neighbours.point(place)[k - 1] - x[k - 1]) / farthest }
        };
        let a = DMatrix::from_fn(near.len(), d + 1, row);
        let b = DVector::from_fn(near.len(), |i, _| least / near[i].1 * value(near[i].0));
        // Places in a line or a plane leave slopes across it open: the least ones are taken.
        let found = a.svd(true, true).solve(&b, 1e-9);
        found.map_or(value(first), |plane| plane[0]).clamp(low, high)
    }
}
