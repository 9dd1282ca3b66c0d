//! Tables as CSV.

use crate::text::printable_lines;

/// A header and rows as CSV text: cells with commas, quotes or line ends are quoted.
pub(super) fn csv<H: AsRef<str>>(header: &[H], rows: &[Vec<String>]) -> String {
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    let header = header.iter().map(|cell| printable_lines(cell.as_ref()).into_owned());
    writer.write_record(header).expect("memory takes a record");
    for row in rows {
        writer.write_record(row.iter().map(|cell| printable_lines(cell).into_owned())).expect("memory takes a record");
    }
    let text = writer.into_inner().expect("memory takes all records");
    String::from_utf8(text).expect("cells are text")
}
