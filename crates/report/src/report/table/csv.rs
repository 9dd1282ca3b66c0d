//! Tables as CSV.

use super::Table;
use crate::text;

impl Table {
    /// The table as CSV, without its notes.
    pub fn csv(&self) -> String {
        let row = |row: &Vec<super::Cell>| row.iter().map(|cell| cell.plain().to_string()).collect();
        let header: Vec<String> = self.columns.iter().map(super::Column::plain_heading).collect();
        csv(&header, &self.rows.iter().map(row).collect::<Vec<_>>())
    }
}

/// A heading, and the text below it of a row.
type Headed<'a, R> = (&'a str, &'a dyn Fn(&R) -> String);

/// A row for each of these as CSV text: each heading stands beside its text of a row.
pub(in crate::report) fn csv_of<R>(rows: &[R], columns: &[Headed<R>]) -> String {
    let header: Vec<&str> = columns.iter().map(|(heading, _)| *heading).collect();
    let row = |row: &R| columns.iter().map(|(_, text)| text(row)).collect();
    csv(&header, &rows.iter().map(row).collect::<Vec<_>>())
}

/// A header and rows as CSV text: cells with commas, quotes or line ends are quoted, and no text is a formula of a spreadsheet.
pub(in crate::report) fn csv<H: AsRef<str>>(header: &[H], rows: &[Vec<String>]) -> String {
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    let cell = |cell: &str| text::csv(&text::printable_lines(cell)).into_owned();
    let header = header.iter().map(|heading| cell(heading.as_ref()));
    writer.write_record(header).expect("memory takes a record");
    for row in rows {
        writer.write_record(row.iter().map(|text| cell(text))).expect("memory takes a record");
    }
    let text = writer.into_inner().expect("memory takes all records");
    String::from_utf8(text).expect("cells are text")
}
