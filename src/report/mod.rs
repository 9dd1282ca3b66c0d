//! What a person or a program reads of an outcome.

mod json;
mod network;
mod pictures;
mod table;

pub use json::report;
pub use network::{network_csv, network_json};
pub use pictures::{displacement_grid, network_grid};
pub use table::{notes, summary, table};

use crate::error::Result;
use crate::file::{create_folder, write_whole};
use crate::mesh::vtk;
use crate::study::{Outcome, Output};
use std::path::{Path, PathBuf};

/// Writes what `output` asks for into `folder`, and returns the paths.
///
/// # Errors
/// The folder or a file cannot be written.
pub fn write_outputs(outcome: &Outcome, output: &Output, folder: &Path) -> Result<Vec<PathBuf>> {
    let mut written = Vec::new();
    let mut files: Vec<(PathBuf, Vec<u8>)> = Vec::new();
    if output.report != Some(false) {
        files.push((folder.join("report.json"), report(outcome).into_bytes()));
    }
    if output.csv {
        for fit in &outcome.fits {
            let text = network_csv(&fit.network);
            files.push((folder.join(format!("{}.csv", file_stem(&fit.fit.name))), text.into_bytes()));
        }
    }
    if !files.is_empty() || output.vtu {
        create_folder(folder)?;
    }
    for (path, content) in files {
        write_whole(&path, &content)?;
        written.push(path);
    }
    if output.vtu {
        let mesh = folder.join("mesh.vtu");
        vtk::write(&mesh, &displacement_grid(outcome))?;
        written.push(mesh);
        for fit in &outcome.fits {
            let path = folder.join(format!("{}.vtu", file_stem(&fit.fit.name)));
            vtk::write(&path, &network_grid(&outcome.mesh, outcome.masses.as_deref(), fit, &outcome.fem))?;
            written.push(path);
        }
    }
    Ok(written)
}

/// A fit's name as part of a file name: `modal 0.1 +bulk` is `modal-0.1-bulk`.
fn file_stem(name: &str) -> String {
    let kept = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
    let dashed: String = name.chars().map(kept).collect();
    dashed.split('-').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("-")
}
