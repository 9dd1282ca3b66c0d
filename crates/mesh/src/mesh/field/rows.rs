//! The rows of a table of comma-, semicolon- or tab-separated cells below a header with the names of the columns.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::reader::quoted;
use csv::{ReaderBuilder, StringRecord};

/// The names of the columns, in lower case.
pub(super) struct Header(Vec<String>);

/// Where a row is in the text.
pub(super) struct Place<'a> {
    /// Without a byte order mark.
    text: &'a str,
    /// The byte at which the row begins.
    pub start: usize,
}

impl Place<'_> {
    /// The line, from 1, of the row that begins at this byte.
    pub fn line_of(&self, start: usize) -> usize {
        line_from(self.text, start)
    }
}

/// Reads the header with `head`, and then each row with what that returned. Blank rows and those
/// that begin with `#` are passed over.
///
/// # Errors
/// The text is no table or has no header, a row has another number of cells than the header, or those of `head` and `body`; they
/// have the line.
pub(super) fn each_row<H>(
    text: &str,
    head: impl Fn(&Header) -> Result<H>,
    mut body: impl FnMut(&Header, &H, &StringRecord, &Place) -> Result<()>,
) -> Result<()> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut rows = ReaderBuilder::new()
        .delimiter(separator(text))
        .comment(Some(b'#'))
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    let (mut known, mut row) = (None, StringRecord::new());
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
        match &known {
            None => {
                let header = Header(row.iter().map(|name| name.trim().to_lowercase()).collect());
                let columns = head(&header).map_err(placed)?;
                known = Some((header, columns));
            }
            Some((header, columns)) => {
                header
                    .check(&row)
                    .and_then(|()| body(header, columns, &row, &Place { text, start }))
                    .map_err(placed)?;
            }
        }
    }
    match known {
        Some(_) => Ok(()),
        None => {
            Err(Error::new("expected a header with the names of the columns, found none").of_kind(ErrorKind::Syntax))
        }
    }
}

impl Header {
    /// The name of a column.
    pub fn name(&self, column: usize) -> &str {
        &self.0[column]
    }

    /// The number of columns.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The names of all columns, for errors.
    pub fn all(&self) -> String {
        self.0.iter().map(|name| quoted(name.as_bytes())).collect::<Vec<_>>().join(", ")
    }

    /// The column of this name, if there is one.
    ///
    /// # Errors
    /// There are two.
    pub fn column(&self, name: &str) -> Result<Option<usize>> {
        let mut found = (0..self.0.len()).filter(|&i| self.0[i] == name);
        match (found.next(), found.next()) {
            (Some(_), Some(_)) => Err(Error::expected(name, "one column of this name, in capitals or not", "two")),
            (first, _) => Ok(first),
        }
    }

    fn check(&self, row: &StringRecord) -> Result<()> {
        if row.len() == self.0.len() {
            return Ok(());
        }
        let expected = format!("{} cells as in the header", self.0.len());
        Err(Error::new(format!("expected {expected}, found {}", row.len())).of_kind(ErrorKind::Syntax))
    }
}

/// A cell, for errors.
pub(super) fn cell(row: &StringRecord, column: usize) -> String {
    quoted(row[column].trim().as_bytes())
}

/// The separator between the names of the header.
fn separator(text: &str) -> u8 {
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
