//! The tables of a paper beside ours, and its figures.

use super::comparison::{Comparison, csv};
use super::deformed::deformed;
use super::surface::surface_figure;
use super::table::aligned;
use super::write_files;
use crate::error::Result;
use crate::study::{Column, Paper, PaperRow, PaperTable};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// What marks a network that does not stand.
const FALLS: &str = "†";

/// A table as text for the terminal.
pub fn paper_text(table: &PaperTable) -> String {
    let (header, rows) = cells(table);
    let mut text = format!("{}: {}\n\n{}", heading(table), table.title, aligned(&header, &rows));
    for line in remarks(table) {
        writeln!(text, "{line}").expect("a String grows");
    }
    text
}

/// All tables as Markdown, with their figures; `figures` are the names of files beside it.
fn markdown(paper: &Paper, figures: &[(String, String)]) -> String {
    let mut text = format!("# {}\n", paper.title);
    for table in &paper.tables {
        let (header, rows) = cells(table);
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let rule: Vec<String> =
            header.iter().enumerate().map(|(i, _)| if i < 2 { "---" } else { "---:" }.to_string()).collect();
        write!(text, "\n## {}: {}\n\n{}{}", heading(table), table.title, line(&header), line(&rule))
            .expect("a String grows");
        rows.iter().for_each(|row| text.push_str(&line(row)));
        for line in remarks(table) {
            write!(text, "\n{line}\n").expect("a String grows");
        }
    }
    for (title, file) in figures {
        write!(text, "\n![{title}]({file})\n").expect("a String grows");
    }
    text
}

/// Writes every table as CSV, all of them as Markdown, and the figures as SVG into `folder`; returns the paths.
///
/// # Errors
/// A figure cannot be drawn; the folder or a file cannot be written.
pub fn write_paper(paper: &Paper, folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files: Vec<(String, String)> = Vec::new();
    for table in &paper.tables {
        files.push((format!("{}.csv", stem(table)), raw(table)));
    }
    let mut figures = Vec::new();
    for table in paper.tables.iter().filter(|table| !table.surfaces.is_empty()) {
        let file = format!("{}.svg", stem(table));
        files.push((file.clone(), surface_figure(&table.title, &table.surfaces)?));
        figures.push((table.title.clone(), file));
    }
    // A scene without loads has no shapes to show.
    for scene in paper.scenes.iter().filter(|scene| !scene.outcome.fem.is_empty()) {
        let outcome = &scene.outcome;
        let precision = format!("{}-precision.svg", scene.stem);
        files.push((precision.clone(), Comparison::of_scene(outcome).plot()?));
        figures.push((format!("{}: error against time to fit", outcome.scene), precision));
        for table in &paper.tables {
            let Some(load) = &table.load else { continue };
            let of_scene = |row: &&PaperRow| row.scene.as_deref() == Some(&scene.stem);
            let Some(row) = table.rows.iter().find(of_scene) else { continue };
            let (_, best) = table.best(&row.object);
            let Some(best) = best else { continue };
            let file = format!("{}-{}.svg", scene.stem, load);
            if files.iter().all(|(name, _)| *name != file)
                && let Some(figure) = deformed(outcome, load, &["frobenius", "spectral", &best.fit])
            {
                files.push((file.clone(), figure));
                figures.push((format!("{} under {load}", outcome.scene), file));
            }
        }
    }
    files.push(("paper.md".into(), markdown(paper, &figures)));
    let named: Vec<(&str, String)> = files.iter().map(|(name, text)| (name.as_str(), text.clone())).collect();
    write_files(folder, &named)
}

/// Table 1, figure 9, torsion.
fn heading(table: &PaperTable) -> String {
    match table.name.chars().next() {
        Some(c) if c.is_ascii_digit() => format!("Table {}", table.name),
        Some(c) => c.to_uppercase().collect::<String>() + &table.name[c.len_utf8()..],
        None => String::new(),
    }
}

fn stem(table: &PaperTable) -> String {
    heading(table).to_lowercase().replace(|c: char| !c.is_ascii_alphanumeric(), "-")
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

/// The rows as they are read: the object once, then a row for each fit, the printed figures beside the found ones.
fn cells(table: &PaperTable) -> (Vec<String>, Vec<Vec<String>>) {
    let columns: Vec<&str> = table.columns.iter().map(|column| column.name()).collect();
    let mut header = vec!["object".to_string(), "fit".into()];
    let printed = table.rows.iter().any(|row| row.printed.is_some());
    if printed {
        header.push(format!("printed {}", columns.join(" / ")));
    }
    header.push(format!("found {}", columns.join(" / ")));
    let mut rows = Vec::new();
    let mut object = "";
    for row in &table.rows {
        let first = row.object != object;
        object = &row.object;
        let join = |values: &[Option<f64>]| {
            let text = |(column, value): (&Column, &Option<f64>)| value.map_or("-".into(), |v| figure(*column, v));
            table.columns.iter().zip(values).map(text).collect::<Vec<_>>().join(" / ")
        };
        let mut cells = vec![if first { row.object.clone() } else { String::new() }, row.fit.clone()];
        if printed {
            let values = |printed: &Vec<f64>| join(&printed.iter().map(|v| Some(*v)).collect::<Vec<_>>());
            cells.push(row.printed.as_ref().map_or(String::new(), values));
        }
        cells.push(join(&row.found) + if row.stands { "" } else { " †" });
        rows.push(cells);
    }
    (header, rows)
}

/// What is told under a table: the best of both, why figures differ, and its note.
fn remarks(table: &PaperTable) -> Vec<String> {
    let mut lines = Vec::new();
    let place = table.columns.iter().position(|c| *c == Column::ERms);
    for object in table.objects() {
        let (printed, found) = table.best(object);
        if let (Some(place), Some(found)) = (place, found) {
            let pair = |values: &[f64]| format!("{:.2} / {:.2}", values[0], values[1]);
            let own: Vec<f64> = found.found[place..].iter().map(|v| v.unwrap_or(f64::NAN)).collect();
            let theirs = printed.and_then(|row| Some((row, &row.printed.as_ref()?[place..])));
            let theirs = theirs.map_or(String::new(), |(row, values)| {
                format!("; the best printed is {} with {}", row.fit, pair(values))
            });
            lines.push(format!("{object}: the best of ours is {} with {}{theirs}", found.fit, pair(&own)));
        }
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
