//! Tables of displacements: a header with the names of the columns, then one row per point.

use super::reading::{AXES, Reading, listed};
use super::rows::{Header, cell, each_row};
use crate::error::{Error, Result};
use csv::StringRecord;

/// The columns that are used.
struct Columns {
    point: Option<usize>,
    /// The column of each direction, or none.
    position: Vec<usize>,
    moved: Vec<Moved>,
}

/// A column of displacements.
struct Moved {
    axis: usize,
    column: usize,
    /// Whether it holds positions after deformation instead of displacements.
    deformed: bool,
}

/// Reads a table; `array` begins the names of the columns of displacements.
///
/// # Errors
/// Columns are missing or repeated; or a row has too few or too many cells, a value that is not a finite number, or a
/// point that is not in the mesh or that had a row before.
pub(super) fn read(text: &str, array: Option<&str>, reading: &mut Reading) -> Result<()> {
    let dimension = reading.mesh.dimension;
    each_row(
        text,
        |header| Columns::new(header, dimension, array),
        |header, columns, row, place| {
            let point = columns.point(header, row, reading)?;
            if let Some(before) = reading.claim(point, place.start) {
                let found = format!("a second one, after line {}", place.line_of(before));
                return Err(Error::expected(format!("point {}", point), "one row", found));
            }
            columns.displace(header, point, row, reading)
        },
    )
}

impl Columns {
    fn new(header: &Header, dimension: usize, array: Option<&str>) -> Result<Columns> {
        let axes = &AXES[..dimension];
        let column = |name: &str| header.column(name);
        let point = column("point")?;
        let position: Vec<Option<usize>> = axes.iter().map(|axis| column(axis)).collect::<Result<_>>()?;
        let position: Vec<usize> = position.into_iter().collect::<Option<_>>().unwrap_or_default();
        if point.is_none() && position.is_empty() {
            let expected = format!("the columns {}, or point", axes.join(", "));
            return Err(Error::expected("header", expected, header.all()));
        }
        let named = |axis: &str| match array {
            None => (format!("u{axis}"), Some(format!("{axis}_deformed"))),
            Some(array) => (format!("{}_{axis}", array.to_lowercase()), None),
        };
        let mut moved = Vec::new();
        for (axis, name) in axes.iter().enumerate() {
            let (by, to) = named(name);
            let columns = (column(&by)?, to.as_deref().map(column).transpose()?.flatten());
            match (columns, to) {
                ((Some(_), Some(_)), Some(to)) => {
                    return Err(Error::expected("header", format!("either {by} or {to}"), "both"));
                }
                ((Some(column), _), _) => moved.push(Moved { axis, column, deformed: false }),
                ((None, Some(column)), _) => moved.push(Moved { axis, column, deformed: true }),
                ((None, None), _) => {}
            }
        }
        if moved.is_empty() {
            let (by, to): (Vec<_>, Vec<_>) = axes.iter().map(|axis| named(axis)).unzip();
            let by = by.join(", ");
            let to: Option<Vec<String>> = to.into_iter().collect();
            let expected = to.map_or(by.clone(), |to| format!("{by} or {}", to.join(", ")));
            return Err(Error::expected("header", format!("some of the columns {expected}"), header.all()));
        }
        Ok(Columns { point, position, moved })
    }

    /// The point of the mesh to which a row belongs.
    fn point(&self, header: &Header, row: &StringRecord, reading: &Reading) -> Result<usize> {
        let count = reading.mesh.point_count();
        let numbered = |&column: &usize| {
            let number = row[column].trim().parse().ok().filter(|number| (0..count).contains(number));
            let expected = || Error::expected("point", format!("a number from 0 to {}", count - 1), cell(row, column));
            number.ok_or_else(expected)
        };
        let number = self.point.as_ref().map(numbered).transpose()?;
        let coordinate = |&column: &usize| {
            let length = self.length(header, row, column, reading)?;
            length.ok_or_else(|| Error::expected(header.name(column), "a number", cell(row, column)))
        };
        let position: Vec<f64> = self.position.iter().map(coordinate).collect::<Result<_>>()?;
        let Some(point) = number else { return reading.point_at(&position, None) };
        if !position.is_empty() {
            let (distance, near) = reading.locator.distance(point, &position);
            if !near {
                let expected = format!("the number, from 0, of the point at {} m", listed(&position));
                return Err(Error::expected("point", expected, format!("{point}, {distance:?} m away")));
            }
        }
        Ok(point)
    }

    fn displace(&self, header: &Header, point: usize, row: &StringRecord, reading: &mut Reading) -> Result<()> {
        for &Moved { axis, column, deformed } in &self.moved {
            let place = point * reading.mesh.dimension + axis;
            let rest = if deformed { reading.mesh.points[place] } else { 0.0 };
            reading.displacements[place] = self.length(header, row, column, reading)?.map(|length| length - rest);
        }
        Ok(())
    }

    /// The length in a cell, m; `None` if it is not measured.
    fn length(&self, header: &Header, row: &StringRecord, column: usize, reading: &Reading) -> Result<Option<f64>> {
        let text = row[column].trim();
        if text.is_empty() {
            return Ok(None);
        }
        let number: f64 =
            text.parse().map_err(|_| Error::expected(header.name(column), "a number", cell(row, column)))?;
        reading.length(number).map_err(|e| e.under(header.name(column)))
    }
}
