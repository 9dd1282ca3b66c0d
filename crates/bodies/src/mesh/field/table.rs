//! Tables of displacements: a header with the names of the columns, then one row per point.

use super::reading::{AXES, Reading, listed};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::reader::quoted;
use csv::{ReaderBuilder, StringRecord};

/// The columns that are used.
struct Columns {
    /// The names in lower case.
    names: Vec<String>,
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
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut rows = ReaderBuilder::new()
        .delimiter(separator(text))
        .comment(Some(b'#'))
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut columns = None;
    let mut row = StringRecord::new();
    loop {
        let start = rows.position().byte() as usize;
        let not_table = |e: csv::Error| Error::new(format!("expected a table: {e}")).of_kind(ErrorKind::Syntax);
        if !rows.read_record(&mut row).map_err(not_table)? {
            break;
        }
        if row.iter().all(|cell| cell.trim().is_empty()) {
            continue;
        }
        let placed = |error: Error| error.on_line(line_from(text, start));
        match &columns {
            None => columns = Some(Columns::new(&row, reading.mesh.dimension, array).map_err(placed)?),
            Some(columns) => {
                let point = columns.point(&row, reading).map_err(placed)?;
                if let Some(before) = reading.claim(point, start) {
                    let found = format!("a second one, after line {}", line_from(text, before));
                    return Err(placed(Error::expected(format!("point {}", point), "one row", found)));
                }
                columns.displace(point, &row, reading).map_err(placed)?;
            }
        }
    }
    if columns.is_none() {
        Err(Error::new("expected a header with the names of the columns, found none").of_kind(ErrorKind::Syntax))
    } else {
        Ok(())
    }
}

/// The separator between the names of the header.
pub(super) fn separator(text: &str) -> u8 {
    let header = text.lines().find(|line| !is_passed_over(line)).unwrap_or_default();
    [b';', b'\t'].into_iter().find(|&mark| header.as_bytes().contains(&mark)).unwrap_or(b',')
}

fn is_passed_over(line: &str) -> bool {
    line.trim().is_empty() || line.starts_with('#')
}

/// The line, from 1, of the first row at or after this byte.
pub(super) fn line_from(text: &str, byte: usize) -> usize {
    let (before, rest) = text.split_at_checked(byte).unwrap_or((text, ""));
    // The end of the previous row may still follow.
    let passed = rest.split_inclusive('\n').take_while(|line| is_passed_over(line)).count();
    1 + before.matches('\n').count() + passed
}

impl Columns {
    fn new(header: &StringRecord, dimension: usize, array: Option<&str>) -> Result<Columns> {
        let names: Vec<String> = header.iter().map(|name| name.trim().to_lowercase()).collect();
        let all = || names.iter().map(|name| quoted(name.as_bytes())).collect::<Vec<_>>().join(", ");
        let axes = &AXES[..dimension];
        let column = |name: &str| {
            let mut found = (0..names.len()).filter(|&i| names[i] == name);
            match (found.next(), found.next()) {
                (Some(_), Some(_)) => Err(Error::expected(name, "one column of this name, in capitals or not", "two")),
                (first, _) => Ok(first),
            }
        };
        let point = column("point")?;
        let position: Vec<Option<usize>> = axes.iter().map(|axis| column(axis)).collect::<Result<_>>()?;
        let position: Vec<usize> = position.into_iter().collect::<Option<_>>().unwrap_or_default();
        if point.is_none() && position.is_empty() {
            let expected = format!("the columns {}, or point", axes.join(", "));
            return Err(Error::expected("header", expected, all()));
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
            return Err(Error::expected("header", format!("some of the columns {expected}"), all()));
        }
        Ok(Columns { names, point, position, moved })
    }

    /// The point of the mesh to which a row belongs.
    fn point(&self, row: &StringRecord, reading: &Reading) -> Result<usize> {
        if row.len() != self.names.len() {
            let expected = format!("{} cells as in the header", self.names.len());
            return Err(Error::new(format!("expected {expected}, found {}", row.len())).of_kind(ErrorKind::Syntax));
        }
        let count = reading.mesh.point_count();
        let numbered = |&column: &usize| {
            let number = row[column].trim().parse().ok().filter(|number| (0..count).contains(number));
            let expected = || Error::expected("point", format!("a number from 0 to {}", count - 1), cell(row, column));
            number.ok_or_else(expected)
        };
        let number = self.point.as_ref().map(numbered).transpose()?;
        let coordinate = |&column: &usize| {
            let length = self.length(row, column, reading)?;
            length.ok_or_else(|| Error::expected(&self.names[column], "a number", cell(row, column)))
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

    fn displace(&self, point: usize, row: &StringRecord, reading: &mut Reading) -> Result<()> {
        for &Moved { axis, column, deformed } in &self.moved {
            let place = point * reading.mesh.dimension + axis;
            let rest = if deformed { reading.mesh.points[place] } else { 0.0 };
            reading.displacements[place] = self.length(row, column, reading)?.map(|length| length - rest);
        }
        Ok(())
    }

    /// The length in a cell, m; `None` if it is not measured.
    fn length(&self, row: &StringRecord, column: usize, reading: &Reading) -> Result<Option<f64>> {
        let text = row[column].trim();
        if text.is_empty() {
            return Ok(None);
        }
        let number: f64 =
            text.parse().map_err(|_| Error::expected(&self.names[column], "a number", cell(row, column)))?;
        reading.length(number).map_err(|e| e.under(&self.names[column]))
    }
}

pub(super) fn cell(row: &StringRecord, column: usize) -> String {
    quoted(row[column].trim().as_bytes())
}
