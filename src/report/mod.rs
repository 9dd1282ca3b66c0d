//! What a person or a program reads of an outcome.

mod agreement;
mod catalogue;
mod check;
mod columns;
mod comparison;
mod convergence;
mod deformed;
mod derivation;
mod figure;
mod fit_record;
mod forecast;
mod former;
mod frequencies;
mod groups;
mod json;
mod linear_theory;
mod load_errors;
mod load_record;
mod material_record;
mod materials;
mod motion;
mod motion_record;
mod network;
mod number;
mod outline;
mod outputs;
pub mod page;
mod paper;
mod pictures;
mod quality;
mod referee;
mod region_record;
mod result_table;
mod rows;
mod series;
mod stability;
mod stretches;
mod study_lines;
mod study_record;
mod study_table;
mod surface;
mod table;
mod typeset;

pub use catalogue::{
    ElementRecord, MaterialRecord, SpringGroupRecord, elements_table, elements_text, materials_table, materials_text,
};
pub use check::{InspectionRecord, PropertyRecord, check_table, check_text};
pub use columns::{Heading, set_page_width};
pub use comparison::{COMPARISON_FILES, Comparison};
pub use convergence::{CONVERGENCE_FILES, convergence_csv, convergence_tables, convergence_text, write_convergence};
pub use deformed::deformed;
pub use derivation::Derivation;
pub use figure::{
    Axis, Chart, Columns, Deformation, Figure, Moduli, ModulusCurve, Picture, PictureFormat, RunFolder, Series, Shape,
};
pub use fit_record::FitRecord;
pub use forecast::forecast_text;
pub use frequencies::FrequencyRecord;
pub use groups::{CellsRecord, GroupRecord, MeshRecord};
pub use json::{AgreementRecord, QualityRecord, Report, VERSION, report, schema};
pub use linear_theory::DeformationRecord;
pub use load_record::{FollowedRecord, LoadRecord, MeasuredRecord, ReadingRecord};
pub use material_record::NetworkMaterialRecord;
pub use motion::motion_csv;
pub use motion_record::{MotionOptionsRecord, MotionRecord};
pub use network::*;
pub use outputs::{check_outputs, check_scene_outputs};
pub use page::page_html;
pub use paper::{PAPER_FILES, paper_result_table, paper_text, write_paper};
pub use pictures::{displacement_grid, network_grid};
pub use quality::mesh_notes;
pub use referee::{
    EngineRecord, Factor, FoundRow, REFEREE_FILES, RefereeRecord, RefereeRow, RepairRecord, Telling, referee_svg,
    referee_tables, referee_text, write_referee,
};
pub use region_record::RegionRecord;
pub use result_table::{CellRecord, ColumnRecord, ResultTable};
pub use series::write_series;
pub use stability::{STABILITY_FILES, stability_table, stability_text, write_stability};
pub use stretches::{STRETCHES_FILES, stretches_tables, stretches_text, write_stretches};
pub use study_lines::StudyLines;
pub use study_record::StudyRecord;
pub use study_table::{StudyTable, planned_table, planned_text, studies_table, studies_text};
pub use table::{notes, notes_beside_summary, summary, table};
pub use typeset::Markup;

use crate::error::Result;
use crate::file::{create_folder, write_whole, write_with};
use crate::mesh::vtk;
use crate::study::{Outcome, Output};
use crate::text::printable_lines;
use former::remove_former;
use outputs::{PAGE, POINTS, REPORT, Stems};
use std::path::{Path, PathBuf};

/// Writes what `output` asks for into `folder`, and returns the paths. What the report of a former run in the folder lists is
/// removed first, except inputs of this run, so that all files there are of one run.
///
/// # Errors
/// The folder or a file cannot be written, or a file of the former run cannot be removed.
pub fn write_outputs(outcome: &Outcome, output: &Output, folder: &Path) -> Result<Vec<PathBuf>> {
    let models = || outcome.motion.iter().flat_map(|motion| &motion.models);
    let names = models().map(|model| model.name.as_str());
    let Stems { fits: stems, motions, points } = Stems::of(outcome.fits.iter().map(|f| f.fit.name.as_str()), names);
    let moved = || models().zip(&motions);
    let mut written = Vec::new();
    let reports = output.report != Some(false);
    let tables = output.csv && !outcome.fits.is_empty();
    let networks = output.json != Some(false) && !outcome.fits.is_empty();
    if tables || networks || moved().next().is_some() || output.vtu || reports {
        create_folder(folder)?;
    }
    remove_former(folder, &outcome.inputs)?;
    for (fit, stem) in outcome.fits.iter().zip(&stems).filter(|_| tables) {
        let path = folder.join(format!("{stem}.csv"));
        write_with(&path, |to| network_csv(&outcome.mesh, &fit.network, to))?;
        written.push(path);
    }
    let names = points_names(outcome, points);
    for (fit, name) in outcome.fits.iter().zip(&names).filter(|_| tables) {
        let path = folder.join(name);
        write_with(&path, |to| points_csv(&NetworkFile::of(outcome, fit), to))?;
        written.push(path);
    }
    for (fit, stem) in outcome.fits.iter().zip(&stems).filter(|_| networks) {
        let path = folder.join(format!("{stem}.json"));
        write_with(&path, |to| network_json(&NetworkFile::of(outcome, fit), to))?;
        written.push(path);
    }
    for (model, stem) in moved() {
        let path = folder.join(format!("{stem}.csv"));
        write_whole(&path, motion_csv(model).as_bytes())?;
        written.push(path);
    }
    if output.vtu {
        let mesh = folder.join("mesh.vtu");
        vtk::write(&mesh, &displacement_grid(outcome))?;
        written.push(mesh);
        for (fit, stem) in outcome.fits.iter().zip(&stems) {
            let path = folder.join(format!("{stem}.vtu"));
            vtk::write(&path, &network_grid(&NetworkFile::of(outcome, fit)))?;
            written.push(path);
        }
        for (model, stem) in moved().filter(|(model, _)| !model.states.is_empty()) {
            written.push(write_series(outcome, model, stem, folder)?);
        }
    }
    let later = [(reports, REPORT), (output.has_page(), PAGE)]
        .into_iter()
        .filter_map(|(is_written, name)| is_written.then_some(name));
    let names = written.iter().filter_map(|path| Some(path.strip_prefix(folder).ok()?.to_string_lossy().into_owned()));
    let files = names.chain(later.map(String::from)).collect();
    // Last: where it is, the others are.
    if reports {
        let path = folder.join(REPORT);
        write_whole(&path, Report { files, ..Report::of(outcome) }.text().as_bytes())?;
        written.push(path);
    }
    if output.has_page() {
        let path = folder.join(PAGE);
        write_with(&path, |to| page_html(outcome, to))?;
        written.push(path);
    }
    Ok(written)
}

/// One file of points if all networks have the same masses, otherwise one for each fit.
fn points_names(outcome: &Outcome, stems: Vec<String>) -> Vec<String> {
    let mut masses = outcome.fits.iter().map(|fit| NetworkFile::of(outcome, fit).masses());
    let first = masses.next();
    match masses.all(|masses| Some(masses) == first) {
        true => vec![POINTS.into()],
        false => stems.iter().map(|stem| format!("{stem}.csv")).collect(),
    }
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
