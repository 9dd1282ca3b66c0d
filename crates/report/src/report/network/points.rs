//! The points of a network as a table.

use super::file::NetworkFile;
use crate::network::write_points;
use std::io::{self, Write};

/// The points of a network, one per line, as [`write_points`](crate::network::write_points) writes them.
///
/// # Errors
/// The writer fails.
pub fn points_csv(file: &NetworkFile, to: &mut dyn Write) -> io::Result<()> {
    write_points(file.mesh, file.masses(), &file.support(), to)
}
