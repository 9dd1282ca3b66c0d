//! Tables of numbers at places: a header with the names of the columns, then one row per place.

use super::raw::{Holder, Raw};
use super::table::{cell, line_from, separator};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::reader::quoted;
use csv::{ReaderBuilder, StringRecord};

/// The columns that are used.
struct Columns {
    /// The names in lower case.
    names: Vec<String>,
    /// Of each direction.
    position: Vec<usize>,
    /// Of each component.
    values: Vec<usize>,
}

/// Reads a table; `array` is the name of the column, or begins the names of several.
///
/// # Errors
/// Columns are missing or repeated; or a row has too few or too many cells, or a value that is not a number.
pub(super) fn read(text: &str, array: Option<&str>, components: usize) -> Result<Raw> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut rows = ReaderBuilder::new()
        .delimiter(separator(text))
        .comment(Some(b'#'))
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    let (mut columns, mut row) = (None, StringRecord::new());
    let mut raw = Raw { holder: Holder::Points, places: Vec::new(), components, values: Vec::new() };
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
            None => columns = Some(Columns::new(&row, array, components).map_err(placed)?),
            Some(columns) => columns.add(&row, &mut raw).map_err(placed)?,
        }
    }
    match columns {
        Some(_) => Ok(raw),
        None => {
            Err(Error::new("expected a header with the names of the columns, found none").of_kind(ErrorKind::Syntax))
        }
    }
}

impl Columns {
    fn new(header: &StringRecord, array: Option<&str>, components: usize) -> Result<Columns> {
        let names: Vec<String> = header.iter().map(|name| name.trim().to_lowercase()).collect();
        let all = || names.iter().map(|name| quoted(name.as_bytes())).collect::<Vec<_>>().join(", ");
        let column = |name: &str| {
            let mut found = (0..names.len()).filter(|&i| names[i] == name);
            match (found.next(), found.next()) {
                (Some(_), Some(_)) => Err(Error::expected(name, "one column of this name, in capitals or not", "two")),
                (first, _) => Ok(first),
            }
        };
        let axes: Vec<Option<usize>> = ["x", "y", "z"].into_iter().map(column).collect::<Result<_>>()?;
        let (Some(x), Some(y), z) = (axes[0], axes[1], axes[2]) else {
            return Err(Error::expected("header", "the columns x, y and, in space, z", all()));
        };
        let position: Vec<usize> = [x, y].into_iter().chain(z).collect();
        let required = |name: String| {
            column(&name)?
                .ok_or_else(|| Error::expected("header", format!("a column {}", quoted(name.as_bytes())), all()))
        };
        let values = match (array.map(str::to_lowercase), components) {
            (Some(array), 1) => vec![required(array)?],
            (Some(array), _) => {
                let names = ["x", "y", "z"].iter().take(components).map(|axis| format!("{array}_{axis}"));
                names.map(required).collect::<Result<_>>()?
            }
            (None, _) => {
                let others: Vec<usize> = (0..names.len()).filter(|i| !position.contains(i)).collect();
                if others.len() != components {
                    let expected = match components {
                        1 => "one column besides the position, or its name as \"array\"".into(),
                        _ => format!("{components} columns besides the position, or their name as \"array\""),
                    };
                    return Err(Error::expected("header", expected, all()));
                }
                others
            }
        };
        Ok(Columns { names, position, values })
    }

    fn add(&self, row: &StringRecord, raw: &mut Raw) -> Result<()> {
        if row.len() != self.names.len() {
            let expected = format!("{} cells as in the header", self.names.len());
            return Err(Error::new(format!("expected {expected}, found {}", row.len())).of_kind(ErrorKind::Syntax));
        }
        let number = |column: usize| {
            let value = row[column].trim().parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| Error::expected(&self.names[column], "a finite number", cell(row, column)))
        };
        let mut place = [0.0; 3];
        for (x, &column) in place.iter_mut().zip(&self.position) {
            *x = number(column)?;
        }
        raw.places.push(place);
        for &column in &self.values {
            raw.values.push(number(column)?);
        }
        Ok(())
    }
}
