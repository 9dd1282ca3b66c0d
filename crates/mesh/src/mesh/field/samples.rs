//! Numbers at places, read from files: what a material is in a body.

use super::neighbours::Neighbours;
use super::raw::{Holder, Raw};
use super::rows::line_from;
use super::{columns, pieces};
use crate::error::{Error, ErrorKind, Result};
use crate::file::{ending, read, read_text};
use crate::mesh::mesh::Mesh;
use crate::mesh::space::spatial;
use crate::mesh::vtk;
use crate::range;
use nalgebra::{DMatrix, DVector};
use springfit_numerics::dense::least_squares;
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
    /// How many places have no value and were left out.
    pub left_out: usize,
}

/// What is read of a file of numbers at places.
#[derive(Debug, Clone, Copy)]
pub struct SampleReading<'a> {
    /// The name of the array, of the column, or the beginning of the names of several columns; `None` if there is one alone.
    pub array: Option<&'a str>,
    /// The unit of the values, as it is told beside the file.
    pub unit: Option<&'a str>,
    /// Metres per unit of the positions.
    pub scale: f64,
    /// How many numbers belong to each place.
    pub components: usize,
    /// The number that says that a place has none.
    pub missing: Option<f64>,
    /// The numbers that are possible.
    pub accepted: Accepted,
}

/// The numbers that a quantity can have.
#[derive(Debug, Clone, Copy)]
pub struct Accepted {
    is_accepted: fn(f64) -> bool,
    /// In words.
    expected: &'static str,
}

impl Accepted {
    /// Any finite number.
    pub const ANY: Accepted = Accepted { is_accepted: f64::is_finite, expected: "a finite number" };

    /// The numbers that the quantity of this key of a material can have.
    pub fn of(key: &str) -> Accepted {
        match key {
            "young" | "thickness" | "density" => {
                Accepted { is_accepted: |x| x > 0.0 && x.is_finite(), expected: "a number above 0" }
            }
            "poisson" => Accepted { is_accepted: |x| x > -1.0 && x <= 0.5, expected: "a number above -1, up to 0.5" },
            _ => Accepted::ANY,
        }
    }
}

/// How many places a plane is fitted to, in each number of dimensions.
// The places are two to three and a half times as many as the `d + 1` numbers of a plane, so that the noise of single
// values is evened out.
const FITTED: [usize; 4] = [1, 4, 8, 14];

impl Samples {
    /// Reads `.csv`, `.vtu` or `.vtk`, according to the extension.
    ///
    /// A table has a header with the columns `x`, `y` (and `z`) and that of the array; without a name the only other column. A grid has
    /// a point or cell array of its name; without a name the only one. Numbers of cells are at the mean of their nodes. Several numbers of a place are in
    /// the columns `array_x`, `array_y`, `array_z` of a table.
    ///
    /// # Errors
    /// The file is missing, of another kind, damaged or cut short; it lacks such columns or such an array; or it has a value that is
    /// not possible, with the line of its row.
    pub fn read(path: &Path, reading: &SampleReading) -> Result<Samples> {
        let SampleReading { array, unit, scale, components, .. } = *reading;
        range::positive("scale", scale, "metres per unit of the file")?;
        let mut text = String::new();
        let raw = match ending(path).as_str() {
            "csv" => {
                text = read_text(path)?;
                columns::read(&text, (array, unit), components)
            }
            "vtu" => vtk::xml_pieces(&read(path)?).and_then(|all| pieces::read(&all, array, components)),
            "vtk" => vtk::legacy_piece(&read(path)?).and_then(|piece| pieces::read(&[piece], array, components)),
            _ => Err(Error::new("expected values ending in .csv, .vtu or .vtk").of_kind(ErrorKind::Unsupported)),
        };
        raw.and_then(|raw| Samples::of(raw, reading, &text)).map_err(|e| e.in_file(path))
    }

    fn of(raw: Raw, reading: &SampleReading, text: &str) -> Result<Samples> {
        let Raw { holder, mut places, components, mut values, mut starts } = raw;
        let mut left_out = 0;
        if let Some(missing) = reading.missing {
            let is_kept: Vec<bool> =
                values.chunks_exact(components).map(|of| of.iter().all(|x| *x != missing)).collect();
            left_out = is_kept.iter().filter(|kept| !**kept).count();
            let kept = |of: usize| is_kept[of];
            values = values
                .chunks_exact(components)
                .enumerate()
                .filter(|(i, _)| kept(*i))
                .flat_map(|(_, x)| x)
                .copied()
                .collect();
            places = places.into_iter().enumerate().filter(|(i, _)| kept(*i)).map(|(_, x)| x).collect();
            starts = starts.into_iter().enumerate().filter(|(i, _)| kept(*i)).map(|(_, x)| x).collect();
        }
        if places.is_empty() {
            let error = Error::new("expected at least one place with a value, found none");
            return Err(if left_out > 0 { error.at_key("missing") } else { error });
        }
        let name = |place: usize| match holder {
            Holder::Points => format!("points[{place}]"),
            Holder::Cells => format!("cells[{place}]"),
        };
        for (place, x) in places.iter_mut().enumerate() {
            x.iter_mut().for_each(|x| *x *= reading.scale);
            if !x.iter().all(|x| x.abs() <= range::LARGEST) {
                return Err(Error::expected(name(place), "finite coordinates", format!("{x:?} m")));
            }
        }
        if let Some(at) = values.iter().position(|value| !(reading.accepted.is_accepted)(*value)) {
            let place = at / components;
            let error = Error::expected(name(place), reading.accepted.expected, values[at]);
            let error = match reading.missing {
                None => error.followed_by(format!("; missing = {:?} leaves out places without a value", values[at])),
                Some(_) => error,
            };
            // A mark of the order of bytes is no part of the text in which rows were counted.
            let line = starts.get(place).map(|start| line_from(text.strip_prefix('\u{feff}').unwrap_or(text), *start));
            return Err(line.into_iter().fold(error, Error::on_line));
        }
        Ok(Samples { holder, components, values, neighbours: Neighbours::new(places), left_out })
    }

    /// To what the numbers belong.
    pub fn holder(&self) -> Holder {
        self.holder
    }

    /// The distance of a position from the box around all places, m.
    pub fn outside(&self, x: &[f64]) -> f64 {
        self.neighbours.outside(&spatial(x))
    }

    /// The distance of a position from the nearest place, m.
    pub fn distance(&self, x: &[f64]) -> f64 {
        self.neighbours.nearest(&spatial(x), 1)[0].1
    }

    /// The largest extent of the box around all places, m.
    pub fn extent(&self) -> f64 {
        self.neighbours.extent()
    }

    /// The largest distance of a place from the nearest other one, m.
    pub fn spacing(&self) -> f64 {
        self.neighbours.spacing()
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
        // The weight of a place that is met would be infinite, and its value is the answer.
        if least <= 1e-9 * farthest || near.len() == 1 {
            return value(first);
        }
        let (low, high) = near.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (place, _)| {
            (low.min(value(*place)), high.max(value(*place)))
        });
        // Equal numbers stay what they are to the last bit: a body of one material gets one constant for all cells.
        if low == high {
            return low;
        }
        let d = x.len();
        let row = |i: usize, k: usize| {
            let (place, distance) = near[i];
            // Relative to the nearest place: weights are at most one, in any unit.
            let weight = least / distance;
            weight * if k == 0 { 1.0 } else { (self.neighbours.point(place)[k - 1] - x[k - 1]) / farthest }
        };
        let a = DMatrix::from_fn(near.len(), d + 1, row);
        let b = DVector::from_fn(near.len(), |i, _| least / near[i].1 * value(near[i].0));
        // Places in a line or a plane leave slopes across it open: the least ones are taken.
        let found = least_squares(a, &b, 1e-9);
        // A plane beyond its places goes on without end; within their range a modulus stays possible.
        found.map_or(value(first), |plane| plane[0]).clamp(low, high)
    }
}
