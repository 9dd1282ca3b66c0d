//! Networks in JSON.

use super::file::NetworkFile;
use std::io::{self, Write};

/// The network with all that is known of it, as [`NetworkRecord`](super::NetworkRecord). Springs are made while they are written, so
/// that no text or list of all of them is held in memory.
///
/// # Errors
/// The writer fails.
pub fn network_json(file: &NetworkFile, to: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer(&mut *to, &file.listed())?;
    to.write_all(b"\n")
}
