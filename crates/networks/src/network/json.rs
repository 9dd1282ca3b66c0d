//! Networks in JSON.

use super::lists::ListedRecord;
use std::io::{self, Write};

/// Writes a record. Its springs are made while they are written, so that no text or list of all of them is held in memory.
///
/// # Errors
/// The writer fails.
pub fn write_json(record: &ListedRecord<'_>, to: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer(&mut *to, record)?;
    to.write_all(b"\n")
}
