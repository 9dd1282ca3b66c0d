//! What a person or a program reads of an outcome.

mod agreement;
mod calibration;
mod catalogue;
mod check;
mod choice;
mod compare;
mod comparison;
mod compliances;
mod convergence;
mod damping;
mod deformed;
mod derivation;
mod element_page;
mod figure;
mod fit_record;
mod forecast;
mod former;
mod frequencies;
mod groups;
mod held_out;
mod json;
mod key_tables;
mod key_types;
mod lattice;
mod linear_theory;
mod materials;
mod measured;
mod motion;
mod motion_record;
mod names;
mod network;
mod note;
mod notes;
mod object;
mod outline;
mod outputs;
mod overview;
pub mod page;
mod paper;
mod pictures;
mod plots;
mod quality;
mod referee;
mod run_tables;
mod sampled;
mod series;
mod sheets;
mod stability;
mod stretches;
mod study_lines;
mod study_record;
mod study_table;
mod summary;
mod surface;
mod table;
mod tables_page;
mod verdict;

pub use calibration::{CALIBRATION_FILES, calibration_tables, calibration_text, write_calibration};
pub use catalogue::{elements_table, materials_table};
pub use check::{check_table, check_text};
pub use choice::Choice;
pub use compare::{
    CASES, COMPARE_FILES, Summary, compare_tables, compare_text, comparison_values, summarized, write_comparison,
};
pub use comparison::{COMPARISON_FILES, Comparison};
pub use compliances::compliances;
pub use convergence::{CONVERGENCE_FILES, convergence_csv, convergence_tables, convergence_text, write_convergence};
pub use deformed::deformed;
pub use derivation::Derivation;
pub use element_page::{element_page_files, write_element_page};
pub use figure::{
    Axis, Chart, Columns, Cost, Deformation, Moduli, ModulusCurve, PictureFormat, RunFolder, Series, Shape,
};
pub use fit_record::FitRecord;
pub use forecast::forecast_text;
pub use groups::NamedMesh;
pub use json::{Report, VERSION, report, schema};
pub use key_tables::{KeyTable, default_words, key_tables, key_tables_text};
pub use lattice::lattice_text;
pub use linear_theory::{DeformationRecord, beyond_linear};
pub use measured::{measured_tables, measured_text};
pub use motion::motion_csv;
pub use motion_record::{MotionOptionsRecord, MotionRecord};
pub use network::*;
pub use notes::{groups_beside_summary, notes, notes_beside_summary, of_locking};
pub use object::Object;
pub use outputs::{open_outputs, open_scene_outputs};
pub use page::page_html;
pub use paper::{PAPER_FILES, paper_table, write_paper};
pub use pictures::{displacement_grid, network_grid};
pub use plots::{Figure, Picture, folder_tables};
pub use quality::mesh_notes;
pub use referee::{
    EngineRecord, Factor, FoundRow, REFEREE_FILES, RefereeRecord, RefereeRow, RepairRecord, Telling, referee_svg,
    referee_tables, referee_text, write_referee,
};
pub use sampled::{shapes_csv, starts_csv};
pub use series::write_series;
pub use stability::{STABILITY_FILES, stability_table, stability_text, write_stability};
pub use stretches::{STRETCHES_FILES, stretches_tables, write_stretches};
pub use study_lines::{Line, StudyLines};
pub use study_record::StudyRecord;
pub use study_table::{
    StudyTable, check_study_page, check_study_table, planned_table, studies_page, studies_table, studies_text,
};
pub use summary::{summary, tables};
pub use table::{Cell, Column, Detail, Markup, Table, set_page};

/// Notes before they are printed, for the tests, which reach public items alone.
#[doc(hidden)]
pub mod parts {
    pub use super::note::{Note, Weight, grouped, ordered};
}

use crate::error::Result;
use crate::file::{Edition, write_whole, write_with};
use crate::mesh::vtk;
use crate::study::{Outcome, Output};
use crate::text::printable_lines;
use names::{PAGE, POINTS, REPORT, Stems};
use std::io::Write;
use std::path::PathBuf;

/// Writes what `output` asks for, and returns the paths. All files in the folder that are of runs are of this one then.
///
/// # Errors
/// A file cannot be written; the folder is as it was.
pub fn write_outputs(outcome: &Outcome, output: &Output, mut edition: Edition) -> Result<Vec<PathBuf>> {
    let models = || outcome.motion.iter().flat_map(|motion| &motion.models);
    let names = models().map(|model| model.name.as_str());
    let Stems { fits: stems, motions, points, sampled } =
        Stems::of(outcome.fits.iter().map(|f| f.fit.name.as_str()), names);
    let moved = || models().zip(&motions);
    let fits = || outcome.fits.iter().zip(&stems);
    if output.csv {
        for (fit, stem) in fits() {
            let write = |to: &mut dyn Write| network_csv(&outcome.mesh, &fit.network, to);
            edition.write(&format!("{stem}.csv"), |path| write_with(path, write))?;
        }
        for (fit, name) in outcome.fits.iter().zip(&points_names(outcome, points)) {
            let write = |to: &mut dyn Write| points_csv(&NetworkFile::of(outcome, fit), to);
            edition.write(name, |path| write_with(path, write))?;
        }
    }
    for (fit, stem) in fits().filter(|_| output.json != Some(false)) {
        let write = |to: &mut dyn Write| network_json(&NetworkFile::of(outcome, fit), to);
        edition.write(&format!("{stem}.json"), |path| write_with(path, write))?;
    }
    for (fit, [shapes, starts]) in outcome.fits.iter().zip(&sampled) {
        let Some(own) = fit.kind.sampled().filter(|own| !own.errors.is_empty()) else { continue };
        edition.write(&format!("{shapes}.csv"), |path| write_with(path, |to| shapes_csv(own, to)))?;
        edition.write(&format!("{starts}.csv"), |path| write_with(path, |to| starts_csv(own, to)))?;
    }
    for (model, stem) in moved() {
        edition.write(&format!("{stem}.csv"), |path| write_whole(path, motion_csv(model).as_bytes()))?;
    }
    if output.vtu {
        edition.write("mesh.vtu", |path| vtk::write(path, &displacement_grid(outcome)))?;
        for (fit, stem) in fits() {
            let grid = || network_grid(&NetworkFile::of(outcome, fit));
            edition.write(&format!("{stem}.vtu"), |path| vtk::write(path, &grid()))?;
        }
        for (model, stem) in moved().filter(|(model, _)| !model.states.is_empty()) {
            write_series(outcome, model, stem, &mut edition)?;
        }
    }
    let reports = output.report != Some(false);
    let later = [(reports, REPORT), (output.has_page(), PAGE)];
    let later = later.into_iter().filter(|(is_written, _)| *is_written).map(|(_, name)| name.to_string());
    // The pictures of a motion are named by its collection.
    let files = edition.names().iter().filter(|name| !name.contains('/')).cloned().chain(later).collect();
    if reports {
        let text = Report { files, ..Report::of(outcome) }.text();
        edition.write(REPORT, |path| write_whole(path, text.as_bytes()))?;
    }
    if output.has_page() {
        edition.write(PAGE, |path| write_with(path, |to| page_html(outcome, to)))?;
    }
    let folder = edition.folder().to_path_buf();
    let paths = edition.publish()?.into_iter();
    Ok(paths.filter(|path| path.parent() == Some(&folder)).collect())
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

/// Writes texts under their names, and returns the paths.
fn write_files<N: AsRef<str>>(mut edition: Edition, files: &[(N, String)]) -> Result<Vec<PathBuf>> {
    for (name, text) in files {
        edition.write(name.as_ref(), |path| write_whole(path, printable_lines(text).as_bytes()))?;
    }
    edition.publish()
}
