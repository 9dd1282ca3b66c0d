//! A calibration as tables, as JSON and as CSV.

use super::table::{Column, Table, csv};
use super::tables_page::tables_page;
use super::write_files;
use crate::error::Result;
use crate::file::Edition;
use crate::study::{CalibratedRegion, CalibrationOutcome, Value};
use crate::text::printable;
use std::fmt::Write;
use std::path::PathBuf;

/// The files that [`write_calibration`] may write.
pub const CALIBRATION_FILES: [&str; 4] = ["report.json", "calibration.html", "moduli.csv", "young.csv"];

/// The moduli of the regions, what the loads have left, and the correlations.
pub fn calibration_tables(outcome: &CalibrationOutcome) -> Vec<Table> {
    let mut all = Vec::new();
    if !outcome.regions.is_empty() {
        all.push(moduli(outcome));
    }
    if !outcome.young_by_cell.is_empty() {
        all.push(field(outcome));
    }
    all.push(loads(outcome));
    if outcome.names.len() > 1 {
        all.push(correlations(outcome));
    }
    all
}

/// The tables under the title of the scene, and the notes.
pub fn calibration_text(outcome: &CalibrationOutcome) -> String {
    let mut text = outcome.distrust().map_or(String::new(), |words| format!("{words}\n"));
    writeln!(text, "{}", printable(&outcome.scene)).expect("a String grows");
    for table in calibration_tables(outcome) {
        write!(text, "\n{}", table.titled_text()).expect("a String grows");
    }
    let is_first = usize::from(outcome.distrust().is_some());
    for note in &outcome.notes[is_first.min(outcome.notes.len())..] {
        writeln!(text, "{note}").expect("a String grows");
    }
    text
}

fn moduli(outcome: &CalibrationOutcome) -> Table {
    let kind = if outcome.by_noise_alone { "95 % by\nnoise alone" } else { "95 %" };
    let mut columns = vec![Column::words("region"), Column::words("modulus"), Column::words("unit")];
    columns.extend([
        Column::numbers("found"),
        Column::numbers(kind).group("interval"),
        Column::numbers("to").group("interval"),
    ]);
    columns.extend([Column::numbers("by noise").unit("%"), Column::numbers("by mesh").unit("%")]);
    let rows = outcome.regions.iter().flat_map(region_rows);
    Table::new("moduli", "moduli by region", columns, rows.collect::<Vec<_>>())
}

/// One row for each modulus; what is known and what follows from nothing that was found are left out.
fn region_rows(region: &CalibratedRegion) -> Vec<Vec<String>> {
    let all = [
        ("E", "Pa", &region.young, false),
        ("nu", "", &region.poisson, true),
        ("mu", "Pa", &region.shear_modulus, false),
        ("lambda", "Pa", &region.lambda, true),
    ];
    let row = |(i, (name, unit, value, is_own)): (usize, (&str, &str, &Value, bool))| {
        let own = |x: f64| match (x.is_finite(), unit) {
            (false, _) => "-".into(),
            (true, "Pa") => format!("{x:.4e}"),
            (true, _) => format!("{x:.4}"),
        };
        let share = |deviation: Option<f64>| {
            // Deviations of E and μ are those of logarithms.
            let unit = if is_own { value.value.abs() } else { 1.0 };
            deviation.map_or("-".into(), |deviation| format!("{:.2}", 100.0 * deviation / unit))
        };
        let ends = value.interval.map_or(["-".into(), "-".into()], |ends| ends.map(own));
        let [low, high] = ends;
        vec![
            if i == 0 { region.region.clone() } else { String::new() },
            name.into(),
            unit.into(),
            own(value.value),
            low,
            high,
            if region.is_known { "known".into() } else { share(value.deviation) },
            share(value.mesh_deviation),
        ]
    };
    all.into_iter().enumerate().map(row).collect()
}

fn field(outcome: &CalibrationOutcome) -> Table {
    let mut sorted = outcome.young_by_cell.clone();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| format!("{:.4e}", sorted[((sorted.len() - 1) as f64 * share).round() as usize]);
    let columns = ["least", "5 %", "median", "95 %", "largest"].map(|name| Column::numbers(name).unit("Pa"));
    let row = [0.0, 0.05, 0.5, 0.95, 1.0].map(at).to_vec();
    Table::new("field", format!("Young's modulus of {} cells", sorted.len()), columns.to_vec(), vec![row])
}

fn loads(outcome: &CalibrationOutcome) -> Table {
    let size = |title| Column::numbers(title).unit("m, N");
    let long = |value: f64| format!("{value:.4e}");
    let short = |value: f64| format!("{value:.3}");
    let chi = match (outcome.chi_square, outcome.degrees_of_freedom, outcome.probability) {
        (Some(square), Some(freedom), Some(probability)) => {
            format!(": chi-square {square:.1} of {freedom} degrees of freedom, probability {probability:.2}")
        }
        _ => String::new(),
    };
    Table::of(
        "residuals",
        format!("residuals by load{chi}"),
        &outcome.loads,
        &[
            (Column::words("load"), &|load| load.load.clone().into()),
            (Column::words("measured"), &|load| load.quantity.clone().into()),
            (Column::numbers("numbers"), &|load| load.measurements.to_string().into()),
            (size("rms"), &|load| long(load.size).into()),
            (size("residual"), &|load| long(load.residual).into()),
            (size("noise"), &|load| load.sigma.map_or("-".into(), long).into()),
            (Column::numbers("residual\nover noise"), &|load| load.misfit.map_or("-".into(), short).into()),
        ],
    )
}

fn correlations(outcome: &CalibrationOutcome) -> Table {
    let mut columns = vec![Column::words("unknown")];
    columns.extend(outcome.names.iter().map(Column::numbers));
    let rows = outcome.names.iter().zip(&outcome.correlations).map(|(name, row)| {
        let cell = |value: &Option<f64>| value.map_or("-".into(), |value| format!("{value:.2}"));
        std::iter::once(name.clone()).chain(row.iter().map(cell)).collect()
    });
    Table::new("correlations", "correlations of the errors by noise", columns, rows.collect::<Vec<Vec<String>>>())
}

/// The moduli of a region with all digits.
fn csv_rows(region: &CalibratedRegion) -> Vec<Vec<String>> {
    let all = [
        ("young", &region.young),
        ("poisson", &region.poisson),
        ("shear_modulus", &region.shear_modulus),
        ("lambda", &region.lambda),
    ];
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:?}"));
    let row = |(name, value): (&str, &Value)| {
        let [low, high] = value.interval.map_or([None; 2], |ends| ends.map(Some));
        let numbers = [Some(value.value), low, high, value.deviation, value.mesh_deviation];
        [region.region.clone(), name.into()].into_iter().chain(numbers.map(number)).collect()
    };
    all.into_iter().map(row).collect()
}

/// Writes `report.json`, a page with the tables, and the moduli of regions or cells as CSV; returns the paths.
///
/// # Errors
/// A file cannot be written, and the folder is as it was.
pub fn write_calibration(outcome: &CalibrationOutcome, edition: Edition) -> Result<Vec<PathBuf>> {
    let [report, page, regions, cells] = CALIBRATION_FILES;
    let json = serde_json::to_string_pretty(outcome).expect("numbers and texts are JSON");
    let about = concat!("Calibration by springfit ", env!("CARGO_PKG_VERSION"));
    let html = tables_page(&outcome.scene, about, [], &calibration_tables(outcome), &outcome.notes);
    let mut files = vec![(report, json + "\n"), (page, html)];
    if !outcome.regions.is_empty() {
        let header = ["region", "modulus", "value", "low", "high", "deviation", "mesh_deviation"];
        files.push((regions, csv(&header, &outcome.regions.iter().flat_map(csv_rows).collect::<Vec<_>>())));
    }
    if !outcome.young_by_cell.is_empty() {
        let mut text = String::from("cell,young,deviation\n");
        for (cell, (young, deviation)) in outcome.young_by_cell.iter().zip(&outcome.deviation_by_cell).enumerate() {
            writeln!(text, "{cell},{young:?},{deviation:?}").expect("a String grows");
        }
        files.push((cells, text));
    }
    write_files(edition, &files)
}
