//! Measured displacements at places of a body, which need not be points of its mesh.

use super::displacements::Field;
use super::reading::AXES;
use super::rows::{Header, cell, each_row};
use crate::error::{Error, Result};
use crate::file::{ending, read_text};
use crate::mesh::mesh::Mesh;
use crate::range;
use csv::StringRecord;
use std::path::Path;

/// Displacements that were measured at places of a body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scattered {
    /// The places at rest, `[places × dimension]`, m.
    pub places: Vec<f64>,
    /// The displacements, `[places × dimension]`, m; `None` of a direction that was not measured.
    pub displacements: Vec<Option<f64>>,
}

impl Scattered {
    /// Reads a table with the columns `x, y, z` and some of `ux, uy, uz`, or any file that [`Field::read_named`] reads, whose values are those
    /// of points of the mesh. Lengths are multiplied by `scale`, in metres per unit of the file; an empty cell or `nan` means not measured.
    ///
    /// # Errors
    /// The file is missing or damaged, lacks such columns, or measures nothing.
    pub fn read(path: &Path, mesh: &Mesh, scale: f64, array: Option<&str>) -> Result<Scattered> {
        let text = if ending(path) == "csv" { read_text(path)? } else { String::new() };
        let axes = &AXES[..mesh.dimension];
        let has = |header: &Header, name: &str| Ok::<bool, Error>(header.column(name)?.is_some());
        // A table that numbers points is one of the mesh; one with places alone stands for itself.
        let mut is_placed = false;
        if ending(path) == "csv" {
            let head = |header: &Header| {
                let numbered = has(header, "point")?;
                let placed = axes.iter().map(|axis| has(header, axis)).collect::<Result<Vec<_>>>()?;
                Ok(!numbered && placed.iter().all(|has| *has))
            };
            each_row(&text, head, |_, placed, _, _| {
                is_placed = *placed;
                Ok(())
            })
            .map_err(|e| e.in_file(path))?;
        }
        if !is_placed {
            let field = Field::read_named(path, mesh, scale, array)?;
            return Ok(
                Scattered { places: mesh.points.clone(), displacements: field.displacements }.known(mesh.dimension)
            );
        }
        range::positive("scale", scale, "metres per unit of the file")?;
        let found = Scattered::rows(&text, axes, scale, array).map_err(|e| e.in_file(path))?;
        let found = found.known(mesh.dimension);
        if found.places.is_empty() {
            return Err(Error::new("expected displacements, found none that was measured").in_file(path));
        }
        Ok(found)
    }

    fn rows(text: &str, axes: &[&str], scale: f64, array: Option<&str>) -> Result<Scattered> {
        let mut all = Scattered::default();
        let head = |header: &Header| {
            let position = axes.iter().map(|axis| header.column(axis)).collect::<Result<Vec<_>>>()?;
            let named = |axis: &&str| match array {
                None => format!("u{axis}"),
                Some(array) => format!("{}_{axis}", array.to_lowercase()),
            };
            let moved = axes.iter().map(|axis| header.column(&named(axis))).collect::<Result<Vec<_>>>()?;
            if moved.iter().all(Option::is_none) {
                let names: Vec<String> = axes.iter().map(named).collect();
                let expected = format!("some of the columns {}", names.join(", "));
                return Err(Error::expected("header", expected, header.all()));
            }
            Ok((position, moved))
        };
        each_row(text, head, |header, (position, moved), row, _| {
            for column in position.iter().flatten() {
                let length = length(header, row, *column, scale)?;
                let missing = || Error::expected(header.name(*column), "a number", cell(row, *column));
                all.places.push(length.ok_or_else(missing)?);
            }
            for column in moved {
                all.displacements.push(column.map_or(Ok(None), |column| length(header, row, column, scale))?);
            }
            Ok(())
        })?;
        Ok(all)
    }

    /// The places at which something was measured.
    fn known(self, dimension: usize) -> Scattered {
        let rows = self.places.chunks_exact(dimension).zip(self.displacements.chunks_exact(dimension));
        let mut known = Scattered::default();
        // A place without any direction would be searched for in the mesh to no end.
        for (place, moved) in rows.filter(|(_, moved)| moved.iter().any(Option::is_some)) {
            known.places.extend(place);
            known.displacements.extend(moved);
        }
        known
    }
}

/// The length in a cell, m; `None` if it is not measured.
fn length(header: &Header, row: &StringRecord, column: usize, scale: f64) -> Result<Option<f64>> {
    let text = row[column].trim();
    if text.is_empty() {
        return Ok(None);
    }
    let wrong = || Error::expected(header.name(column), "a number", cell(row, column));
    let number: f64 = text.parse().map_err(|_| wrong())?;
    match number {
        number if number.is_nan() => Ok(None),
        number if (number * scale).is_finite() => Ok(Some(number * scale)),
        _ => Err(wrong()),
    }
}
