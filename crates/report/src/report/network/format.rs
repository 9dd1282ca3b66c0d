//! The file formats that networks are written in.

use super::file::NetworkFile;
use super::json::network_json;
use crate::error::{Error, ErrorKind, Result};
use crate::file::write_with;
use crate::mesh::vtk;
use crate::network::{network_csv, write_npz};
use crate::report::pictures::network_grid;
use std::path::Path;

/// A format, known by the ending of its files.
pub struct NetworkFormat {
    /// The ending of its files, without a dot.
    pub ending: &'static str,
    /// Whether its files hold the errors of the elements' matrices.
    pub has_errors: bool,
    write: fn(&Path, &NetworkFile) -> Result<()>,
}

/// A new format is a row here.
pub const NETWORK_FORMATS: [NetworkFormat; 4] = [
    NetworkFormat { ending: "vtu", has_errors: false, write: |path, file| vtk::write(path, &network_grid(file)) },
    NetworkFormat {
        ending: "json",
        has_errors: true,
        write: |path, file| write_with(path, |to| network_json(file, to)),
    },
    NetworkFormat {
        ending: "csv",
        has_errors: false,
        write: |path, file| write_with(path, |to| network_csv(file.mesh, file.network, to)),
    },
    NetworkFormat {
        ending: "npz",
        has_errors: false,
        write: |path, file| write_npz(path, &file.listed(), file.mesh, file.network),
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
    /// The file cannot be written, the format does not hold all springs of the network, or a law of force is a function.
    pub fn write(&self, path: &Path, file: &NetworkFile) -> Result<()> {
        file.network.check_formulas()?;
        (self.write)(path, file)
    }
}
