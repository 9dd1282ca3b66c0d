//! The file formats that networks are written in.

use super::network::{network_csv, network_json};
use super::pictures::network_grid;
use crate::error::{Error, ErrorKind, Result};
use crate::file::write_with;
use crate::mesh::{Mesh, vtk};
use crate::study::{BodyLoad, FitOutcome};
use std::path::Path;

/// A fitted network and what belongs to it.
pub struct NetworkFile<'a> {
    pub mesh: &'a Mesh,
    /// `[points]`, kg.
    pub masses: Option<&'a [f64]>,
    pub fit: &'a FitOutcome,
    /// The loads whose displacements are written, where the format holds them.
    pub loads: &'a [BodyLoad],
    /// What a reader must know of the fit, where the format holds it.
    pub notes: &'a [String],
}

/// A format, known by the ending of its files.
pub struct NetworkFormat {
    pub ending: &'static str,
    write: fn(&Path, &NetworkFile) -> Result<()>,
}

/// A new format is a row here.
pub const NETWORK_FORMATS: [NetworkFormat; 3] = [
    NetworkFormat {
        ending: "vtu",
        write: |path, file| vtk::write(path, &network_grid(file.mesh, file.masses, file.fit, file.loads)),
    },
    NetworkFormat {
        ending: "json",
        write: |path, file| {
            write_with(path, |to| network_json(file.mesh, file.masses, &file.fit.network, file.notes, to))
        },
    },
    NetworkFormat {
        ending: "csv",
        write: |path, file| write_with(path, |to| network_csv(file.mesh, &file.fit.network, to)),
    },
];

impl NetworkFormat {
    /// The format of the file at `path`, by its ending.
    ///
    /// # Errors
    /// No format has this ending; kind `Unsupported`.
    pub fn of(path: &Path) -> Result<&'static NetworkFormat> {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        NETWORK_FORMATS.iter().find(|format| format.ending == ending).ok_or_else(|| {
            let expected = format!("a file ending in {}", NetworkFormat::endings());
            Error::new(format!("expected {expected}, found {}", path.display())).of_kind(ErrorKind::Unsupported)
        })
    }

    /// `.a, .b or .c`.
    pub fn endings() -> String {
        let [others @ .., last] = NETWORK_FORMATS.map(|format| format!(".{}", format.ending));
        format!("{} or {last}", others.join(", "))
    }

    /// Writes the network.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path, file: &NetworkFile) -> Result<()> {
        (self.write)(path, file)
    }
}
