//! Networks as the files and scripts of other programs.
//!
//! A target is a file here and a row of [`TARGETS`]; its script, where it has one, is in the folder `exports`.
//!
//! Page of the book: *Networks in other programs*.

mod job;
mod jolt;
mod lammps;
mod mujoco;
mod newton;
mod npz;
mod sofa;
mod vtu;

pub use job::{Holds, Job, Tension};

use crate::error::Result;
use crate::file::write_whole;
use crate::mesh::vtk::{self, Grid};
use crate::report::NetworkRecord;
use crate::unknown;
use std::path::Path;

/// A file by its name.
pub type NamedFile = (&'static str, Content);

/// What is in a file.
pub enum Content {
    Bytes(Vec<u8>),
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
    write: fn(&NetworkRecord, Option<&[f64]>) -> Result<Vec<NamedFile>>,
}

/// A new target is a row here.
pub const TARGETS: [Target; 7] =
    [mujoco::TARGET, newton::TARGET, lammps::TARGET, jolt::TARGET, sofa::TARGET, npz::TARGET, vtu::TARGET];

impl Target {
    /// The target of this name.
    ///
    /// # Errors
    /// There is none; the key is `--to`.
    pub fn named(name: &str) -> Result<&'static Target> {
        let names = || TARGETS.iter().map(|target| target.name);
        let expected = format!("one of {}", names().collect::<Vec<_>>().join(", "));
        let found = TARGETS.iter().find(|target| target.name == name);
        found.ok_or_else(|| unknown(expected, names(), name).at_key("--to"))
    }

    /// The files of a network. `gravity` is in m/s², `[dimension]`; that of the network if it is absent, or 9.81 m/s² against the
    /// last axis.
    ///
    /// # Errors
    /// The program does not hold the network; the error says what it holds and which fit has it.
    pub fn files(&self, network: &NetworkRecord, gravity: Option<&[f64]>) -> Result<Vec<NamedFile>> {
        (self.write)(network, gravity)
    }

    /// A line for each target: its name and its title.
    pub fn list() -> String {
        TARGETS.iter().map(|target| format!("  {:9} {}\n", target.name, target.title)).collect()
    }
}

fn nothing(_: &NetworkRecord) -> Vec<String> {
    Vec::new()
}

/// That dampers are left out, if there are some.
fn dampers(network: &NetworkRecord) -> Vec<String> {
    let count = network.springs.iter().filter(|spring| spring.damper != 0.0).count();
    (count > 0).then(|| format!("{count} dampers of springs are left out")).into_iter().collect()
}
