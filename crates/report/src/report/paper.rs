//! The tables of a paper beside ours, and its figures.

use super::comparison::Comparison;
use super::deformed::deformed;
use super::surface::surface_figure;
use super::table::{Cell, Column, Table, csv, markdown_body};
use super::write_files;
use crate::error::Result;
use crate::file::Edition;
use crate::order::{distinct, grouped};
use crate::study::{self, Paper, PaperRow, PaperTable, file_stem, heading};
use std::fmt::Write;
use std::path::PathBuf;

/// What marks a network that does not stand.
const FALLS: &str = "†";

/// A table of a paper: the object once, then a row for each fit, the printed figures beside the found ones.
pub fn paper_table(table: &PaperTable) -> Table {
    let printed = table.rows.iter().any(|row| row.printed.is_some());
    let mut columns = ["object", "fit"].map(Column::words).to_vec();
    for group in ["printed", "found"].into_iter().filter(|group| printed || *group == "found") {
        columns.extend(table.columns.iter().map(|what| column(*what, group)));
    }
    let cell = |(what, value): (&study::Column, Option<f64>)| Cell::from(text(*what, value));
    let row = |(i, row): (usize, &PaperRow)| {
        let is_first = i == 0 || table.rows[i - 1].object != row.object;
        let mut cells = vec![Cell::from(if is_first { &*row.object } else { "" }), Cell::from(&*row.fit)];
        match &row.printed {
            Some(values) => cells.extend(table.columns.iter().zip(values.iter().copied().map(Some)).map(cell)),
            None if printed => cells.extend(vec![Cell::from(""); table.columns.len()]),
            None => {}
        }
        cells.extend(table.columns.iter().zip(row.found.iter().copied()).map(cell));
        let last = cells.pop().map(|last| if row.stands { last } else { last.marked(&format!(" {FALLS}")) });
        cells.extend(last);
        cells
    };
    let title = format!("{}: {}", heading(&table.name), table.title);
    let rows = table.rows.iter().enumerate().map(row);
    Table::new(&table.name, title, columns, rows).with_notes(remarks(table))
}

/// The column of a figure, printed or found.
fn column(what: study::Column, group: &str) -> Column {
    Column::numbers(what.name()).unit(what.unit()).group(group)
}

/// All tables as Markdown, with their figures; `figures` are the names of files beside it.
fn markdown(paper: &Paper, figures: &[(String, String)]) -> String {
    let mut text = format!("# {}\n", paper.title);
    for table in paper.tables.iter().map(paper_table) {
        text += &format!("\n## {}\n\n{}", table.title, markdown_body(&table));
    }
    for (title, file) in figures {
        write!(text, "\n![{title}](<{file}>)\n").expect("a String grows");
    }
    text
}

/// What [`write_paper`] writes whatever the tables are.
pub const PAPER_FILES: [&str; 1] = ["paper.md"];

/// Writes every table as CSV, all of them as Markdown, and the figures as SVG into `folder`; returns the paths.
///
/// # Errors
/// A figure cannot be drawn; a file cannot be written, and the folder is as it was.
pub fn write_paper(paper: &Paper, edition: Edition) -> Result<Vec<PathBuf>> {
    let mut files: Vec<(String, String)> = Vec::new();
    for table in &paper.tables {
        files.push((format!("{}.csv", file_stem(&table.name)), raw(table)));
    }
    let mut figures = Vec::new();
    for table in paper.tables.iter().filter(|table| !table.surfaces.is_empty()) {
        let file = format!("{}.svg", file_stem(&table.name));
        files.push((file.clone(), surface_figure(&table.title, &table.surfaces)?));
        figures.push((table.title.clone(), file));
    }
    // A scene without loads has no shapes to show.
    for scene in paper.scenes.iter().filter(|scene| !scene.outcome.loads.is_empty()) {
        let outcome = &scene.outcome;
        let precision = format!("{}.precision.svg", scene.stem);
        files.push((precision.clone(), Comparison::of_scene(outcome).plot()?));
        figures.push((format!("{}: error against time to fit", outcome.scene), precision));
        for table in &paper.tables {
            let Some(load) = &table.load else { continue };
            let of_scene = |row: &&PaperRow| row.scene.as_deref() == Some(&scene.stem);
            let Some(row) = table.rows.iter().find(of_scene) else { continue };
            let (_, best) = table.best(&row.object);
            let Some(best) = best else { continue };
            let plain = load.replace(|c: char| !c.is_ascii_alphanumeric(), "-");
            let file = format!("{}-{plain}.svg", scene.stem);
            if files.iter().all(|(name, _)| *name != file)
                && let Some(figure) = deformed(outcome, load, &["frobenius", "spectral", &best.fit])
            {
                files.push((file.clone(), figure));
                figures.push((format!("{} under {load}", outcome.scene), file));
            }
        }
    }
    files.push((PAPER_FILES[0].into(), markdown(paper, &figures)));
    write_files(edition, &files)
}

fn figure(column: study::Column, value: f64) -> String {
    match column {
        study::Column::ERms | study::Column::EMax => format!("{value:.2}"),
        study::Column::Young => format!("{value:.1}"),
        study::Column::Poisson => format!("{value:.3}"),
        study::Column::Seconds if value < 1e-2 => format!("{value:.2e}"),
        study::Column::Seconds => format!("{value:.2}"),
        study::Column::Frames => format!("{value:.0}"),
        study::Column::YoungRatio => format!("{value:.3}"),
        study::Column::PoissonShift => format!("{value:+.3}"),
    }
}

fn text(column: study::Column, value: Option<f64>) -> String {
    value.map_or("-".into(), |value| figure(column, value))
}

/// The lines below a table: the best of both, why figures differ, and its note.
fn remarks(table: &PaperTable) -> Vec<String> {
    let mut lines = Vec::new();
    let errors = |values: &[Option<f64>]| {
        let shown =
            table.columns.iter().zip(values).filter(|(c, _)| matches!(c, study::Column::ERms | study::Column::EMax));
        shown.map(|(column, value)| text(*column, *value)).collect::<Vec<_>>().join(" / ")
    };
    for object in table.objects() {
        let (printed, found) = table.best(object);
        let Some(found) = found else { continue };
        let theirs = printed.and_then(|row| Some((row, row.printed.as_ref()?)));
        let theirs = theirs.map_or(String::new(), |(row, values)| {
            let values: Vec<Option<f64>> = values.iter().map(|v| Some(*v)).collect();
            format!("; the best printed is {} with {}", row.fit, errors(&values))
        });
        lines.push(format!("{object}: the best of ours is {} with {}{theirs}", found.fit, errors(&found.found)));
    }
    let reasons = grouped(table.rows.iter().filter_map(|row| Some((row.why.as_deref()?, row.fit.as_str()))));
    let told = reasons.into_iter().map(|(why, fits)| (why, distinct(fits).join(", ")));
    lines.extend(told.map(|(why, fits)| format!("Differs from print, {fits}: {why}")));
    if table.rows.iter().any(|row| !row.stands) {
        lines.push(format!("{FALLS} the network does not stand (indefinite, or near a mechanism)"));
    }
    lines.extend(table.note.clone());
    lines
}

/// All figures in full, one row for each fit.
fn raw(table: &PaperTable) -> String {
    let mut header = vec!["object".to_string(), "fit".into(), "stands".into()];
    for what in &table.columns {
        header.extend(["printed", "found"].map(|group| column(*what, group).plain_heading()));
    }
    header.push("why".into());
    let row = |row: &PaperRow| {
        let mut cells = vec![row.object.clone(), row.fit.clone(), row.stands.to_string()];
        for (i, found) in row.found.iter().enumerate() {
            let text = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
            cells.extend([text(row.printed.as_ref().map(|p| p[i])), text(*found)]);
        }
        cells.push(row.why.clone().unwrap_or_default());
        cells
    };
    let mut text = csv(&header, &table.rows.iter().map(row).collect::<Vec<_>>());
    for surface in &table.surfaces {
        let header = ["fit", "E_in", "nu_in", "E_out", "nu_out"].map(String::from);
        let asked = surface.young.iter().flat_map(|e| surface.poisson.iter().map(move |nu| (e, nu)));
        let rows = asked.zip(&surface.found).map(|((e, nu), found)| {
            let found = found.map_or([String::new(), String::new()], |found| found.map(|v| v.to_string()));
            [vec![surface.fit.clone(), e.to_string(), nu.to_string()], found.into()].concat()
        });
        text += &("\n".to_string() + &csv(&header, &rows.collect::<Vec<_>>()));
    }
    text
}
