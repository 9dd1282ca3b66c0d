//! What an export is: a row for each program, and its files.

use crate::error::Result;
use crate::file::write_whole;
use crate::mesh::vtk::{self, Grid};
use crate::report::NetworkRecord;
use std::path::Path;

/// A file by its name.
pub type NamedFile = (&'static str, Content);

/// What is in a file.
pub enum Content {
    /// Bytes as they are.
    Bytes(Vec<u8>),
    /// A grid, written as VTU.
    Grid(Box<Grid>),
}

impl Content {
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        match self {
            Content::Bytes(bytes) => write_whole(path, bytes),
            Content::Grid(grid) => vtk::write(path, grid),
        }
    }
}

/// Makes the files of a network with a gravity that may be given.
type Writer = fn(&NetworkRecord, Option<&[f64]>) -> Result<Vec<NamedFile>>;

/// A program that networks are written for.
pub struct Target {
    /// The word after `--to`.
    pub name: &'static str,
    /// The program and what it gets, in words.
    pub title: &'static str,
    /// What a user types in the folder; empty of files that are read by hand.
    pub command: &'static str,
    /// The springs that are left out, for the line that says so.
    pub leaves_out: fn(&NetworkRecord) -> Vec<String>,
    pub(super) write: Writer,
}

impl Target {
    /// The files of a network. `gravity` is in m/s², `[dimension]`; that of the network if it is absent, or 9.81 m/s² against the
    /// last axis.
    ///
    /// # Errors
    /// The program does not hold the network; the error says what it holds and which fit has it.
    pub fn files(&self, network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
        (self.write)(network, gravity)
    }
}

pub(super) fn nothing(_: &NetworkRecord) -> Vec<String> {
    Vec::new()
}

/// That dampers are left out, if there are some.
pub(super) fn dampers(network: &NetworkRecord) -> Vec<String> {
    let count = network.springs.iter().filter(|spring| spring.damper != 0.0).count();
    (count > 0).then(|| format!("{count} dampers of springs are left out")).into_iter().collect()
}
