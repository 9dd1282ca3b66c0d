//! Tables of numbers at places: a header with the names of the columns, then one row per place.

use super::raw::{Holder, Raw};
use super::rows::{Header, cell, each_row};
use crate::error::{Error, Result};
use crate::mesh::reader::quoted;
use csv::StringRecord;
use std::collections::HashMap;

/// The columns that are used.
struct Columns {
    /// The position is in these columns, one for each direction.
    position: Vec<usize>,
    /// The values are in these columns, one for each component.
    values: Vec<usize>,
}

/// Reads a table; `array` is the name of the column, or begins the names of several, and `unit` that of its values as it is told beside the file.
///
/// # Errors
/// Columns are missing or repeated; or the header names another unit; or a row has too few or too many cells, or a value that is not a number; or two
/// rows at the same place have different values.
pub(super) fn read(text: &str, (array, unit): (Option<&str>, Option<&str>), components: usize) -> Result<Raw> {
    let mut raw =
        Raw { holder: Holder::Points, places: Vec::new(), components, values: Vec::new(), starts: Vec::new() };
    let head = |header: &Header| {
        let columns = Columns::new(header, array, components)?;
        columns.values.iter().try_for_each(|&column| check_unit(header.name(column), unit))?;
        Ok(columns)
    };
    // The coordinates of each row, its index, and where it begins in the text.
    let mut known: HashMap<[u64; 3], (usize, usize)> = HashMap::new();
    each_row(text, head, |header, columns, row, at| {
        let index = raw.places.len();
        columns.add(header, row, &mut raw)?;
        raw.starts.push(at.start);
        // The sum makes no difference between the zeros of both signs.
        let (first, earlier) =
            // Places of a table are compared by their bits: rows that differ in the last digit are two places.
            *known.entry(raw.places[index].map(|x| (x + 0.0).to_bits())).or_insert((index, at.start));
        let of = |place: usize| &raw.values[place * components..(place + 1) * components];
        match of(first) == of(index) {
            true => Ok(()),
            false => {
                let line = at.line_of(earlier);
                let expected = format!("the values of line {line}, which is at the same place");
                Err(Error::expected("values", expected, format!("{:?}", of(index))))
            }
        }
    })?;
    Ok(raw)
}

/// That a column `E (kPa)` or `E [kPa]` has the unit that is told beside the file. Names are in lower case.
fn check_unit(name: &str, unit: Option<&str>) -> Result<()> {
    let Some((_, own)) = name.trim_end_matches([')', ']']).split_once(['(', '[']) else { return Ok(()) };
    let own = own.trim();
    if own.is_empty() || unit.is_some_and(|unit| unit.trim().to_lowercase() == own) {
        return Ok(());
    }
    let found = unit.map_or("none".into(), |unit| format!("\"{unit}\""));
    Err(Error::expected("unit", format!("that of the column {}", quoted(name.as_bytes())), found))
}

impl Columns {
    fn new(header: &Header, array: Option<&str>, components: usize) -> Result<Columns> {
        let axes: Vec<Option<usize>> =
            ["x", "y", "z"].into_iter().map(|axis| header.column(axis)).collect::<Result<_>>()?;
        let (Some(x), Some(y), z) = (axes[0], axes[1], axes[2]) else {
            return Err(Error::expected("header", "the columns x, y and, in space, z", header.all()));
        };
        let position: Vec<usize> = [x, y].into_iter().chain(z).collect();
        let required = |name: String| {
            header
                .column(&name)?
                .ok_or_else(|| Error::expected("header", format!("a column {}", quoted(name.as_bytes())), header.all()))
        };
        let values = match (array.map(str::to_lowercase), components) {
            (Some(array), 1) => vec![required(array)?],
            (Some(array), _) => {
                let names = ["x", "y", "z"].iter().take(components).map(|axis| format!("{array}_{axis}"));
                names.map(required).collect::<Result<_>>()?
            }
            (None, _) => {
                let others: Vec<usize> = (0..header.len()).filter(|i| !position.contains(i)).collect();
                if others.len() != components {
                    let expected = match components {
                        1 => "one column besides the position, or its name as \"array\"".into(),
                        _ => format!("{components} columns besides the position, or their name as \"array\""),
                    };
                    return Err(Error::expected("header", expected, header.all()));
                }
                others
            }
        };
        Ok(Columns { position, values })
    }

    fn add(&self, header: &Header, row: &StringRecord, raw: &mut Raw) -> Result<()> {
        let number = |column: usize| {
            let value = row[column].trim().parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| Error::expected(header.name(column), "a finite number", cell(row, column)))
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
