//! What a person or a program reads of an outcome.

mod agreement;
mod check;
mod columns;
mod comparison;
mod convergence;
mod convergence_plot;
mod deformed;
mod derivation;
mod fit_record;
mod frequencies;
mod json;
mod load_record;
mod material_record;
mod materials;
mod motion;
mod motion_record;
mod network;
mod network_format;
mod number;
mod paper;
mod pictures;
mod rows;
mod series;
mod stability;
mod stretches;
mod surface;
mod table;

pub use check::{InspectionRecord, PropertyRecord, check_json, check_text};
pub use columns::Heading;
pub use comparison::Comparison;
pub use convergence::{convergence_csv, convergence_text, write_convergence};
pub use deformed::deformed;
pub use derivation::Derivation;
pub use fit_record::FitRecord;
pub use frequencies::FrequencyRecord;
pub use json::{AgreementRecord, QualityRecord, Report, VERSION, report};
pub use load_record::{FollowedRecord, LoadRecord, MeasuredRecord, ReadingRecord};
pub use material_record::NetworkMaterialRecord;
pub use motion::motion_csv;
pub use motion_record::{MotionOptionsRecord, MotionRecord};
pub use network::{network_csv, network_json};
pub use network_format::{NETWORK_FORMATS, NetworkFile, NetworkFormat};
pub use paper::{paper_text, write_paper};
pub use pictures::{displacement_grid, network_grid};
pub use series::write_series;
pub use stability::{stability_text, write_stability};
pub use stretches::{stretches_text, write_stretches};
pub use table::{notes, summary, table};

use crate::error::Result;
use crate::file::{create_folder, write_whole};
use crate::mesh::vtk;
use crate::study::{Outcome, Output};
use crate::text::printable_lines;
use std::path::{Path, PathBuf};

/// Writes what `output` asks for into `folder`, and returns the paths.
///
/// # Errors
/// The folder or a file cannot be written.
pub fn write_outputs(outcome: &Outcome, output: &Output, folder: &Path) -> Result<Vec<PathBuf>> {
    let moved = outcome.motion.iter().flat_map(|motion| &motion.models);
    let moved: Vec<String> = moved.map(|model| format!("motion {}", model.name)).collect();
    let fits = outcome.fits.iter().map(|f| f.fit.name.as_str());
    let mut stems = file_stems(fits.chain(moved.iter().map(String::as_str)));
    let motion_stems = stems.split_off(outcome.fits.len());
    let moved = || outcome.motion.iter().flat_map(|motion| &motion.models).zip(&motion_stems);
    let mut written = Vec::new();
    let mut files: Vec<(PathBuf, Vec<u8>)> = Vec::new();
    if output.csv {
        for (fit, stem) in outcome.fits.iter().zip(&stems) {
            files.push((folder.join(format!("{stem}.csv")), network_csv(&fit.network).into_bytes()));
        }
    }
    for (model, stem) in moved() {
        files.push((folder.join(format!("{stem}.csv")), motion_csv(model).into_bytes()));
    }
    let reports = output.report != Some(false);
    if !files.is_empty() || output.vtu || reports {
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
        for (fit, stem) in outcome.fits.iter().zip(&stems) {
            let path = folder.join(format!("{stem}.vtu"));
            vtk::write(&path, &network_grid(&outcome.mesh, outcome.masses.as_deref(), fit, &outcome.loads))?;
            written.push(path);
        }
        for (model, stem) in moved().filter(|(model, _)| !model.states.is_empty()) {
            written.push(write_series(outcome, model, stem, folder)?);
        }
    }
    // Last: where it is, the others are.
    if reports {
        let path = folder.join("report.json");
        write_whole(&path, report(outcome).as_bytes())?;
        written.push(path);
    }
    Ok(written)
}

/// Writes texts under their names into `folder`, and returns the paths.
fn write_files<N: AsRef<Path>>(folder: &Path, files: &[(N, String)]) -> Result<Vec<PathBuf>> {
    create_folder(folder)?;
    let write = |(name, text): &(N, String)| {
        let path = folder.join(name);
        write_whole(&path, printable_lines(text).as_bytes())?;
        Ok(path)
    };
    files.iter().map(write).collect()
}

/// Each name as the stem of a file of its own: `modal 0.1 +bulk` is `modal-0.1-bulk`.
fn file_stems<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut stems = vec!["mesh".to_string()];
    for name in names {
        let kept = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
        let dashed: String = name.chars().map(kept).collect();
        let stem = dashed.split('-').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("-");
        let numbered = (2..).map(|i| format!("{stem}-{i}"));
        let free = std::iter::once(stem.clone()).chain(numbered).find(|s| !s.is_empty() && !stems.contains(s));
        stems.extend(free);
    }
    stems.split_off(1)
}
