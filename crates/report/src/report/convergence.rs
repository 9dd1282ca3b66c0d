//! A convergence study as tables, as CSV and as a plot of errors against cell size.

use super::figure::{CONVERGENCE_TABLE, Columns, convergence_charts, stacked};
use super::summary::size;
use super::table::Priority::Always;
use super::table::{Column, Table, csv_of};
use super::write_files;
use crate::error::Result;
use crate::file::Edition;
use crate::study::{Convergence, Level, Limit, LimitKind, LoadConvergence, ModelConvergence, QUADRATIC, Step, rates};
use crate::text::printable;
use std::fmt::Write;
use std::path::PathBuf;

fn columns() -> Vec<Column> {
    vec![
        Column::words("model"),
        Column::words("level").priority(Always),
        Column::numbers("h").unit("mm"),
        Column::numbers("cells"),
        Column::numbers("unknowns").priority(Always),
        Column::numbers("compliance").unit("J"),
        Column::numbers("of finite\nelements").unit("%"),
        Column::numbers("of the\ntruth").unit("%").priority(Always),
        Column::numbers("rate").priority(Always),
        Column::numbers("displacements\ne_rms").unit("%").priority(Always),
        Column::words("network").priority(Always),
    ]
}

/// The tables under the title of the scene.
pub fn convergence_text(convergence: &Convergence) -> String {
    let mut text = format!("{}\n{} on every level\n", printable(&convergence.scene), size(&convergence.extent));
    for table in convergence_tables(convergence) {
        write!(text, "\n{}", table.titled_text()).expect("a String grows");
    }
    text
}

/// One table for each load.
pub fn convergence_tables(convergence: &Convergence) -> Vec<Table> {
    let table = |load: &LoadConvergence| {
        let name = format!("convergence {}", load.name);
        Table::new(&name, load_title(convergence, load), columns(), load_rows(convergence, load))
    };
    convergence.loads.iter().map(table).collect()
}

fn load_title(convergence: &Convergence, load: &LoadConvergence) -> String {
    let truth = truth_text(load.truth.as_ref(), convergence.reference.as_deref());
    format!("{}: {truth}", load.name)
}

fn load_rows(convergence: &Convergence, load: &LoadConvergence) -> Vec<Vec<String>> {
    load.models.iter().enumerate().flat_map(|(i, model)| rows(convergence, load, model, i == 0)).collect()
}

/// One row per level, and one for the limit where it is extrapolated.
fn rows(convergence: &Convergence, load: &LoadConvergence, model: &ModelConvergence, body: bool) -> Vec<Vec<String>> {
    let (of_body, of_truth) = (load.of_body(model), load.of_truth(model));
    let rates = rates(&of_truth);
    let words = |status: &str| if body && status == "solved" { String::new() } else { status.to_string() };
    let row = |(i, step): (usize, &crate::study::Step)| {
        let level = &convergence.levels[i];
        vec![
            if i == 0 { model.name.clone() } else { String::new() },
            (i + 1).to_string(),
            millimetres(level.size),
            level.cells.to_string(),
            level.unknowns.to_string(),
            step.compliance.map_or("-".into(), |value| format!("{value:.6e}")),
            if body { String::new() } else { share(of_body[i]) },
            share(of_truth[i]),
            rates[i].map_or(String::new(), |rate| format!("{rate:.2}")),
            if body { String::new() } else { share(step.rms) },
            words(step.status),
        ]
    };
    let mut rows: Vec<Vec<String>> = model.steps.iter().enumerate().map(row).collect();
    if let Some((limit, order)) = model.limit().and_then(|limit| Some((limit, limit.order()?))) {
        let of_truth = load.truth.and_then(|truth| load.softer(limit.value, truth.value));
        let mut row = vec![String::new(); rows[0].len()];
        row[1] = "limit".into();
        row[5] = format!("{:.6e}", limit.value);
        let is_truth = body && convergence.reference.is_none();
        row[7] = if is_truth { String::new() } else { share(of_truth) };
        row[8] = format!("{order:.2}");
        rows.push(row);
    }
    rows
}

/// A length in mm, with four digits behind the point or five in all where that says nothing.
fn millimetres(size: f64) -> String {
    match 1e3 * size {
        size @ 0.1..1e5 => format!("{size:.4}"),
        size => format!("{size:.4e}"),
    }
}

/// Signed, with two digits behind the point or two in all where that says nothing.
fn share(percent: Option<f64>) -> String {
    match percent {
        None => "-".into(),
        Some(0.0) => "0".into(),
        Some(value) if value.abs() < 0.01 => format!("{value:.1e}"),
        Some(value) => format!("{value:.2}"),
    }
}

/// What the errors refer to, and how far that is to be trusted.
fn truth_text(truth: Option<&Limit>, reference: Option<&str>) -> String {
    let models = match reference {
        None => "finite elements".into(),
        Some(QUADRATIC) => QUADRATIC.into(),
        Some(title) => format!("finite elements of \"{title}\""),
    };
    let Some(limit) = truth else {
        return "no truth is known, because the finite elements do not reach the load on every level, or lock".into();
    };
    let finest = format!("the truth is taken to be {:.6e} J of the finest {models}", limit.value);
    let uncertain = format!("{} %", share(Some(100.0 * (limit.uncertainty / limit.value).abs())));
    match limit.kind {
        LimitKind::Extrapolated(order) => format!(
            "the truth is {:.6e} J, extrapolated from the {models} with order {order:.2}, uncertain by {uncertain}",
            limit.value
        ),
        LimitKind::Constant => format!("{finest}: the two finest levels agree to rounding"),
        LimitKind::TooFew => {
            format!("{finest}, which differ by {uncertain} from the level before: an extrapolation needs three levels")
        }
        LimitKind::NotMonotonic => {
            format!(
                "{finest}, which differ by {uncertain} from the level before: the levels do not converge monotonically"
            )
        }
        LimitKind::Growing => format!(
            "there is no truth, because the differences between levels grow: errors are relative to the {:.6e} J of the finest \
             {models}, which differ by {uncertain} from the level before",
            limit.value
        ),
        LimitKind::TooSlow(order) => format!(
            "{finest}, which differ by {uncertain} from the level before: they converge with order {order:.2} only, \
             too slowly to extrapolate"
        ),
    }
}

/// The one word for how the truth was found, in the CSV file.
fn truth_word(kind: LimitKind) -> &'static str {
    match kind {
        LimitKind::Extrapolated(_) => "extrapolated",
        LimitKind::Constant => "constant",
        LimitKind::TooFew => "finest-of-two",
        LimitKind::NotMonotonic => "finest-not-monotonic",
        LimitKind::Growing => "finest-growing",
        LimitKind::TooSlow(_) => "finest-too-slow",
    }
}

/// One model at one level under one load.
struct Row<'a> {
    load: &'a LoadConvergence,
    model: &'a str,
    number: usize,
    level: &'a Level,
    step: &'a Step,
    /// Over the finite elements and over the truth, the rate, and the mean displacement over the truth.
    curves: [Option<f64>; 4],
}

/// One row for each load, model and level.
pub fn convergence_csv(convergence: &Convergence) -> String {
    let mut rows = Vec::new();
    for load in &convergence.loads {
        for model in &load.models {
            let (of_body, of_truth, mean) = (load.of_body(model), load.of_truth(model), load.mean_of_truth(model));
            let rates = rates(&of_truth);
            rows.extend(convergence.levels.iter().zip(&model.steps).enumerate().map(|(i, (level, step))| {
                let curves = [of_body[i], of_truth[i], rates[i], mean[i]];
                Row { load, model: &model.name, number: i + 1, level, step, curves }
            }));
        }
    }
    let full = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:e}"));
    csv_of(
        &rows,
        &[
            ("load", &|row| row.load.name.clone()),
            ("model", &|row| row.model.into()),
            ("level", &|row| row.number.to_string()),
            ("h_m", &|row| format!("{:e}", row.level.size)),
            ("cells", &|row| row.level.cells.to_string()),
            ("points", &|row| row.level.points.to_string()),
            ("unknowns", &|row| row.level.unknowns.to_string()),
            ("compliance_J", &|row| full(row.step.compliance)),
            ("of_finite_elements_percent", &|row| full(row.curves[0])),
            ("of_truth_percent", &|row| full(row.curves[1])),
            ("rate", &|row| full(row.curves[2])),
            ("e_rms_percent", &|row| full(row.step.rms)),
            ("mean_displacement_m", &|row| full(row.step.mean_displacement)),
            ("mean_displacement_of_truth_percent", &|row| full(row.curves[3])),
            ("status", &|row| row.step.status.into()),
            ("truth_J", &|row| full(row.load.truth.map(|truth| truth.value))),
            ("truth", &|row| row.load.truth.map_or("none", |truth| truth_word(truth.kind)).into()),
            ("truth_uncertainty_percent", &|row| {
                full(row.load.truth.map(|truth| 100.0 * (truth.uncertainty / truth.value).abs()))
            }),
        ],
    )
}

/// What [`write_convergence`] writes.
pub const CONVERGENCE_FILES: [&str; 2] = [CONVERGENCE_TABLE, "converge.svg"];

/// Writes `converge.csv` and, where any error is above zero, `converge.svg`, and returns the paths.
///
/// # Errors
/// The plot cannot be drawn; a file cannot be written, and the folder is as it was.
pub fn write_convergence(convergence: &Convergence, edition: Edition) -> Result<Vec<PathBuf>> {
    let [table, figure] = CONVERGENCE_FILES;
    let text = convergence_csv(convergence);
    let charts = convergence_charts(&text)?;
    let title = format!("{}: errors against cell size", convergence.scene);
    let mut files = vec![(table, text)];
    if !charts.is_empty() {
        files.push((figure, stacked(&title, &charts, Columns::Two)?));
    }
    write_files(edition, &files)
}
