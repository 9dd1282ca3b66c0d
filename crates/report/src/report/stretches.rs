//! Tables and figures of springs at large deformation.

use super::figure::COLORS;
use super::table::{Column, Table};
use super::write_files;
use crate::error::{Error, Result};
use crate::file::Edition;
use crate::order::grouped;
use crate::study::{STRETCHES, StretchedFit, Stretches};
use plotters::prelude::*;
use std::path::PathBuf;

/// Names and points of the lines of a figure.
type Lines = Vec<(String, Vec<(f64, f64)>)>;

/// The errors of the displacements, those of the force, and fits of more and more shapes.
pub fn stretches_tables(study: &Stretches) -> [Table; 3] {
    [
        of_fits(study, "stretch", format!("{}; e_rms in %", title(study)), |fit| &fit.errors),
        of_fits(study, "force", "Force at the pulled end, % above the body's".into(), |fit| &fit.excess),
        samples(study),
    ]
}

/// What [`write_stretches`] writes.
pub const STRETCHES_FILES: [&str; 6] =
    ["stretch.csv", "samples.csv", "force.csv", "stretch.svg", "force.svg", "samples.svg"];

/// Writes `stretch`, `force` and `samples` as CSV and SVG files, and returns the paths.
///
/// # Errors
/// A figure cannot be drawn; a file cannot be written, and the folder is as it was.
pub fn write_stretches(study: &Stretches, edition: Edition) -> Result<Vec<PathBuf>> {
    let [errors, forces, samples] = stretches_tables(study);
    let against_stretch = |values: fn(&StretchedFit) -> &Vec<Option<f64>>| -> Lines {
        let line = |fit: &StretchedFit| {
            let points = STRETCHES.iter().zip(values(fit)).filter_map(|(s, e)| Some((100.0 * s, (*e)?.abs())));
            (fit.name.clone(), points.collect())
        };
        study.fits.iter().map(line).collect()
    };
    let runs = study.runs.iter();
    let timed: Lines = grouped(runs.map(|run| (run.name.clone(), (1e3 * run.seconds, 100.0 * run.held_out))));
    let files = [
        (STRETCHES_FILES[0], errors.csv()),
        (STRETCHES_FILES[1], samples.csv()),
        (STRETCHES_FILES[2], forces.csv()),
        (STRETCHES_FILES[3], figure(&title(study), ["stretch, %", "e_rms, %"], &against_stretch(|fit| &fit.errors))?),
        (
            STRETCHES_FILES[4],
            figure(
                &title(study),
                ["stretch, %", "error of the force that pulls, %"],
                &against_stretch(|fit| &fit.excess),
            )?,
        ),
        (
            STRETCHES_FILES[5],
            figure(
                &format!("{}: 10 to 100 000 shapes, one element on one thread", study.element),
                ["fit, ms", "error of the forces at shapes held out, %"],
                &timed,
            )?,
        ),
    ];
    write_files(edition, &files)
}

fn title(study: &Stretches) -> String {
    format!("{}: a box held at both ends and stretched, {}", study.element, study.law.to_lowercase())
}

fn of_fits(study: &Stretches, name: &str, title: String, values: fn(&StretchedFit) -> &Vec<Option<f64>>) -> Table {
    let mut columns = vec![Column::words("fit"), Column::numbers("time").unit("µs/element")];
    columns.extend(STRETCHES.map(|s| Column::numbers(format!("{} %", 100.0 * s))));
    let row = |fit: &StretchedFit| {
        let time = fit.times.as_ref().map_or("-".into(), |times| format!("{:.1}", 1e6 * times.median));
        let mut row = vec![fit.name.clone(), time];
        row.extend(values(fit).iter().map(|e| e.map_or("-".into(), |e| format!("{e:.3}"))));
        row
    };
    Table::new(name, title, columns, study.fits.iter().map(row))
}

fn samples(study: &Stretches) -> Table {
    let mut columns = vec![Column::words("fit"), Column::numbers("shapes"), Column::numbers("time").unit("ms")];
    columns.extend(["fitted", "held out"].map(|title| Column::numbers(title).unit("%")));
    let rows = study.runs.iter().map(|run| {
        let percent = |share: f64| format!("{:.3}", 100.0 * share);
        let (shapes, seconds) = (run.shapes.to_string(), format!("{:.2}", 1e3 * run.seconds));
        vec![run.name.clone(), shapes, seconds, percent(run.trained), percent(run.held_out)]
    });
    Table::new("samples", format!("{}, one element on one thread", study.element), columns, rows)
}

/// Lines over logarithmic axes, an SVG file's text; what is below a thousandth of the largest value is drawn there.
fn figure(title: &str, axes: [&str; 2], lines: &Lines) -> Result<String> {
    let all = || lines.iter().flat_map(|(_, points)| points).filter(|(x, y)| *x > 0.0 && y.is_finite());
    let (least, largest) = all().fold((f64::INFINITY, 0.0f64), |(a, b), (x, _)| (a.min(*x), b.max(*x)));
    let highest = all().map(|(_, y)| *y).fold(0.0, f64::max);
    if highest <= 0.0 {
        return Err(Error::new("nothing to plot: no fit has an error above zero"));
    }
    let mut text = String::new();
    let range = [(least / 1.1, 1.1 * largest), (highest * 1e-3, 1.3 * highest)];
    draw(&mut text, title, axes, lines, range).map_err(|e| Error::new(format!("the plot cannot be drawn: {e}")))?;
    Ok(text)
}

fn draw(
    text: &mut String,
    title: &str,
    [across, up]: [&str; 2],
    lines: &Lines,
    [x, y]: [(f64, f64); 2],
) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::with_string(text, (980, 520)).into_drawing_area();
    area.fill(&WHITE)?;
    let (plot, names) = area.split_horizontally(720);
    let mut chart = ChartBuilder::on(&plot)
        .margin(16)
        .caption(title, ("sans-serif", 17))
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d((x.0..x.1).log_scale(), (y.0..y.1).log_scale())?;
    let number = |v: &f64| format!("{}", (v * 1e4).round() / 1e4);
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc(across)
        .y_desc(up)
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .label_style(("sans-serif", 13))
        .draw()?;
    for (i, (name, points)) in lines.iter().enumerate() {
        let color = COLORS[i % COLORS.len()];
        let shown: Vec<(f64, f64)> = points.iter().map(|(x, error)| (*x, error.max(y.0))).collect();
        let label = 30 + 22 * i as i32;
        chart.draw_series(LineSeries::new(shown.iter().copied(), color.stroke_width(2)))?;
        chart.draw_series(shown.iter().map(|&at| Circle::new(at, 4, color.filled())))?;
        names.draw(&PathElement::new([(6, label + 7), (24, label + 7)], color.stroke_width(2)))?;
        names.draw(&Circle::new((15, label + 7), 4, color.filled()))?;
        names.draw(&Text::new(name.clone(), (32, label), ("sans-serif", 14)))?;
    }
    area.present()?;
    Ok(())
}
