//! Networks in JSON.

use super::file::NetworkFile;
use crate::network::write_json;
use std::io::{self, Write};

/// The network with all that is known of it, as [`NetworkRecord`](super::NetworkRecord).
///
/// # Errors
/// The writer fails.
pub fn network_json(file: &NetworkFile, to: &mut dyn Write) -> io::Result<()> {
    write_json(file.listed(), to)
}
