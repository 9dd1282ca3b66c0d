//! Errors of a convergence study against the size of the cells, both logarithmic.

use super::comparison::COLORS;
use crate::error::{Error, Result};
use crate::study::{Convergence, LoadConvergence};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;

/// Pixels: of a panel, and of the names beside it.
const PANEL: (i32, i32) = (620, 430);
const NAMES: i32 = 340;
const LINE: i32 = 22;

type Fallible = std::result::Result<(), Box<dyn std::error::Error>>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Errors above zero by cell size in mm, of one model.
struct Curve {
    name: String,
    points: Vec<(f64, f64)>,
}

/// One panel for each load that has an error above zero; an SVG file's text, `None` if no load has one.
///
/// # Errors
/// The drawing library has none that an outcome can cause.
pub fn plot(convergence: &Convergence) -> Result<Option<String>> {
    let panels: Vec<(String, Vec<Curve>)> =
        convergence.loads.iter().map(|load| (load.name.clone(), curves(convergence, load))).collect();
    let drawn = |panel: &&(String, Vec<Curve>)| panel.1.iter().any(|curve| !curve.points.is_empty());
    let panels: Vec<_> = panels.iter().filter(drawn).collect();
    if panels.is_empty() {
        return Ok(None);
    }
    let mut text = String::new();
    draw(&mut text, convergence, &panels).map_err(|e| Error::new(format!("the plot cannot be drawn: {e}")))?;
    Ok(Some(text))
}

fn curves(convergence: &Convergence, load: &LoadConvergence) -> Vec<Curve> {
    let curve = |model| {
        let errors = load.of_truth(model).into_iter().map(|e| e.map(f64::abs).filter(|e| *e > 0.0));
        let points = convergence.levels.iter().zip(errors).filter_map(|(level, e)| Some((1e3 * level.size, e?)));
        (model, points.collect())
    };
    load.models.iter().map(curve).map(|(model, points)| Curve { name: model.name.clone(), points }).collect()
}

fn draw(text: &mut String, convergence: &Convergence, panels: &[&(String, Vec<Curve>)]) -> Fallible {
    let names = panels[0].1.len() as i32;
    let height = (PANEL.1 * panels.len() as i32).max(LINE * (names + 2) + 60) + 40;
    let area = SVGBackend::with_string(text, ((PANEL.0 + NAMES) as u32, height as u32)).into_drawing_area();
    area.fill(&WHITE)?;
    area.draw(&Text::new(convergence.scene.clone(), (16, 12), ("sans-serif", 18)))?;
    let (_, below) = area.split_vertically(36);
    let (left, right) = below.split_horizontally(PANEL.0);
    for (i, (load, curves)) in panels.iter().enumerate() {
        let top = PANEL.1 * i as i32;
        panel(&left.clone().shrink((0, top), PANEL), load, curves)?;
    }
    legend(&right, &panels[0].1)?;
    area.present()?;
    Ok(())
}

fn panel(area: &Area, load: &str, curves: &[Curve]) -> Fallible {
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let sizes = widened(points().map(|p| p.0), 1.25);
    let errors = decades(points().map(|p| p.1));
    let mut chart = ChartBuilder::on(area)
        .margin(14)
        .caption(load, ("sans-serif", 16))
        .x_label_area_size(44)
        .y_label_area_size(70)
        .build_cartesian_2d(sizes.clone().log_scale(), errors.clone().log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc("cell size h, mm")
        .y_desc("|error of the compliance|, % of the truth")
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .label_style(("sans-serif", 13))
        .draw()?;
    // Slopes of orders 1 and 2 through the finite elements' coarsest error.
    if let Some(&(h, e)) = curves.first().and_then(|body| body.points.first()) {
        for order in [1, 2] {
            let at = |size: f64| e * (size / h).powi(order);
            let least = sizes.start.max(h * (errors.start / e).powf(1.0 / f64::from(order)));
            let line = DashedLineSeries::new([(h, e), (least, at(least))], 4, 4, GUIDE.stroke_width(1));
            chart.draw_series(line)?;
        }
    }
    for (i, curve) in curves.iter().enumerate() {
        let color = COLORS[i % COLORS.len()];
        let width = if i == 0 { 3 } else { 2 };
        chart.draw_series(LineSeries::new(curve.points.iter().copied(), color.stroke_width(width)))?;
        for point in &curve.points {
            match i / COLORS.len() % 3 {
                0 => {
                    chart.draw_series([Circle::new(*point, 4, color.filled())])?;
                }
                1 => {
                    chart.draw_series([TriangleMarker::new(*point, 6, color.filled())])?;
                }
                _ => {
                    chart.draw_series([Cross::new(*point, 4, color.stroke_width(2))])?;
                }
            }
        }
    }
    Ok(())
}

const GUIDE: RGBColor = RGBColor(150, 150, 150);

fn legend(area: &Area, curves: &[Curve]) -> Fallible {
    let style = ("sans-serif", 14);
    for (i, curve) in curves.iter().enumerate() {
        let color = COLORS[i % COLORS.len()];
        let y = 34 + LINE * i as i32;
        let width = if i == 0 { 3 } else { 2 };
        area.draw(&PathElement::new([(8, y + 7), (40, y + 7)], color.stroke_width(width)))?;
        match i / COLORS.len() % 3 {
            0 => area.draw(&Circle::new((24, y + 7), 4, color.filled()))?,
            1 => area.draw(&TriangleMarker::new((24, y + 7), 6, color.filled()))?,
            _ => area.draw(&Cross::new((24, y + 7), 4, color.stroke_width(2)))?,
        }
        let nothing = if curve.points.is_empty() { ": no error above zero" } else { "" };
        area.draw(&Text::new(format!("{}{nothing}", curve.name), (48, y), style))?;
    }
    let y = 34 + LINE * curves.len() as i32;
    for at in [8, 18, 28] {
        area.draw(&PathElement::new([(at, y + 7), (at + 5, y + 7)], GUIDE.stroke_width(1)))?;
    }
    area.draw(&Text::new("orders 1 and 2", (48, y), style))?;
    Ok(())
}

/// The range of values, a factor larger on both sides.
fn widened(values: impl Iterator<Item = f64>, factor: f64) -> Range<f64> {
    let (least, largest) = values.fold((f64::INFINITY, 0.0f64), |(lo, hi), v| (lo.min(v), hi.max(v)));
    least / factor..largest * factor
}

/// Whole decades around the values.
fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let range = widened(values, 1.3);
    // A little more, so that rounding does not take the numbers at the ends from the axis.
    10f64.powf(range.start.log10().floor()) * 0.999..10f64.powf(range.end.log10().ceil()) * 1.001
}

fn number(v: &f64) -> String {
    if *v >= 0.01 && *v < 1e5 { format!("{}", (v * 1e4).round() / 1e4) } else { format!("{v:.0e}") }
}
