//! The tables of a paper beside ours, and its figures.

use super::columns::{Heading, aligned, texts};
use super::comparison::Comparison;
use super::deformed::deformed;
use super::result_table::ResultTable;
use super::rows::csv;
use super::surface::surface_figure;
use super::write_files;
use crate::error::Result;
use crate::file::Edition;
use crate::study::{Column, Paper, PaperRow, PaperTable, file_stem, heading};
use std::fmt::Write;
use std::path::PathBuf;

/// What marks a network that does not stand.
const FALLS: &str = "†";

/// A table as text for the terminal.
pub fn paper_text(table: &PaperTable) -> String {
    let (header, rows) = cells(table);
    let mut text = format!("{}: {}\n\n{}", heading(&table.name), table.title, aligned(&header, &rows));
    for line in remarks(table) {
        writeln!(text, "{line}").expect("a String grows");
    }
    text
}

/// A table of a paper, to be typeset.
pub fn paper_result_table(table: &PaperTable) -> ResultTable {
    let (header, rows) = cells(table);
    ResultTable::printed(&table.name, &format!("{}: {}", heading(&table.name), table.title), &header, &rows)
}

/// All tables as Markdown, with their figures; `figures` are the names of files beside it.
fn markdown(paper: &Paper, figures: &[(String, String)]) -> String {
    let mut text = format!("# {}\n", paper.title);
    for table in &paper.tables {
        let (header, rows) = cells(table);
        // A bar in a name would end its cell.
        let line = |cells: &[String]| {
            format!("| {} |\n", cells.iter().map(|c| c.replace('|', "\\|")).collect::<Vec<_>>().join(" | "))
        };
        let rule: Vec<String> =
            header.iter().enumerate().map(|(i, _)| if i < 2 { "---" } else { "---:" }.to_string()).collect();
        write!(
            text,
            "\n## {}: {}\n\n{}{}",
            heading(&table.name),
            table.title,
            line(&texts(&header).into_iter().map(String::from).collect::<Vec<_>>()),
            line(&rule)
        )
        .expect("a String grows");
        rows.iter().for_each(|row| text.push_str(&line(row)));
        for line in remarks(table) {
            write!(text, "\n{line}\n").expect("a String grows");
        }
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

fn figure(column: Column, value: f64) -> String {
    match column {
        Column::ERms | Column::EMax => format!("{value:.2}"),
        Column::Young => format!("{value:.1}"),
        Column::Poisson => format!("{value:.3}"),
        Column::Seconds if value < 1e-2 => format!("{value:.2e}"),
        Column::Seconds => format!("{value:.2}"),
        Column::Frames => format!("{value:.0}"),
        Column::YoungRatio => format!("{value:.3}"),
        Column::PoissonShift => format!("{value:+.3}"),
    }
}

fn joined<'a>(figures: impl Iterator<Item = (&'a Column, &'a Option<f64>)>) -> String {
    let text = |(column, value): (&Column, &Option<f64>)| value.map_or("-".into(), |v| figure(*column, v));
    figures.map(text).collect::<Vec<_>>().join(" / ")
}

/// The rows as they are read: the object once, then a row for each fit, the printed figures beside the found ones.
fn cells(table: &PaperTable) -> (Vec<Heading>, Vec<Vec<String>>) {
    let columns: Vec<&str> = table.columns.iter().map(|column| column.name()).collect();
    let mut header = ["object", "fit"].map(Heading::words).to_vec();
    let printed = table.rows.iter().any(|row| row.printed.is_some());
    if printed {
        header.push(Heading::numbers(format!("printed {}", columns.join(" / "))));
    }
    header.push(Heading::numbers(format!("found {}", columns.join(" / "))));
    let mut rows = Vec::new();
    let mut object = "";
    for row in &table.rows {
        let first = row.object != object;
        object = &row.object;
        let join = |values: &[Option<f64>]| joined(table.columns.iter().zip(values));
        let mut cells = vec![if first { row.object.clone() } else { String::new() }, row.fit.clone()];
        if printed {
            let values = |printed: &Vec<f64>| join(&printed.iter().map(|v| Some(*v)).collect::<Vec<_>>());
            cells.push(row.printed.as_ref().map_or(String::new(), values));
        }
        let mark = if row.stands { String::new() } else { format!(" {FALLS}") };
        cells.push(join(&row.found) + &mark);
        rows.push(cells);
    }
    (header, rows)
}

/// The lines below a table: the best of both, why figures differ, and its note.
fn remarks(table: &PaperTable) -> Vec<String> {
    let mut lines = Vec::new();
    let errors = |values: &[Option<f64>]| {
        let shown = table.columns.iter().zip(values).filter(|(c, _)| matches!(c, Column::ERms | Column::EMax));
        joined(shown)
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
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for row in &table.rows {
        let Some(why) = &row.why else { continue };
        match reasons.iter_mut().find(|(known, _)| known == why) {
            Some((_, fits)) if fits.contains(&row.fit.as_str()) => {}
            Some((_, fits)) => fits.push(&row.fit),
            None => reasons.push((why, vec![&row.fit])),
        }
    }
    lines.extend(reasons.iter().map(|(why, fits)| format!("Differs from print, {}: {why}", fits.join(", "))));
    if table.rows.iter().any(|row| !row.stands) {
        lines.push(format!("{FALLS} the network does not stand (indefinite, or near a mechanism)"));
    }
    lines.extend(table.note.clone());
    lines
}

/// All figures in full, one row for each fit.
fn raw(table: &PaperTable) -> String {
    let mut header = vec!["object".to_string(), "fit".into(), "stands".into()];
    for column in &table.columns {
        header.extend([format!("printed {}", column.name()), format!("found {}", column.name())]);
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
