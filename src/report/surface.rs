//! Moduli of networks as surfaces over the constants that were asked for.

use crate::error::{Error, Result};
use crate::study::Surface;
use plotters::coord::ranged3d::ProjectionMatrixBuilder;
use plotters::prelude::*;

/// Pixels of one surface, and of the title above them all.
const PANEL: (u32, u32) = (380, 320);
const TITLE: u32 = 34;

/// For each fit a row of two surfaces, `E_out` and `ν_out` over `E_in` (decades) and `ν_in`; an SVG file's text. What was asked
/// for is drawn as a grid of grey lines.
///
/// # Errors
/// Nothing is known of any fit.
pub fn surface_figure(title: &str, surfaces: &[Surface]) -> Result<String> {
    let shown: Vec<&Surface> = surfaces.iter().filter(|s| s.found.iter().any(Option::is_some)).collect();
    if shown.is_empty() {
        return Err(Error::new("nothing to plot: no fit has moduli"));
    }
    let mut text = String::new();
    draw(&mut text, title, &shown).map_err(|e| Error::new(format!("the plot cannot be drawn: {e}")))?;
    Ok(text)
}

fn draw(text: &mut String, title: &str, surfaces: &[&Surface]) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let size = (2 * PANEL.0, TITLE + PANEL.1 * surfaces.len() as u32);
    let area = SVGBackend::with_string(text, size).into_drawing_area();
    area.fill(&WHITE)?;
    let axes = "across log10 E_in and nu_in; grey: what was asked for";
    let area = area.titled(title, ("sans-serif", 18))?.titled(axes, ("sans-serif", 13))?;
    for (surface, row) in surfaces.iter().zip(area.split_evenly((surfaces.len(), 1))) {
        let panels = row.split_evenly((1, 2));
        let young = |e: f64, _: f64| e.log10();
        panel(&panels[0], surface, "log10 E_out", &young, &|found| found[0].log10())?;
        panel(&panels[1], surface, "nu_out", &|_, nu| nu, &|found| found[1])?;
    }
    area.present()?;
    Ok(())
}

fn panel(
    area: &DrawingArea<SVGBackend, plotters::coord::Shift>,
    surface: &Surface,
    what: &str,
    asked: &dyn Fn(f64, f64) -> f64,
    value: &dyn Fn([f64; 2]) -> f64,
) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let decades: Vec<f64> = surface.young.iter().map(|e| e.log10()).collect();
    let ratios = &surface.poisson;
    let found = |i: usize, j: usize| surface.found[i * ratios.len() + j].map(value);
    let cells = || (0..decades.len()).flat_map(|i| (0..ratios.len()).map(move |j| (i, j)));
    let wanted = |i: usize, j: usize| asked(surface.young[i], ratios[j]);
    let heights = || cells().flat_map(|(i, j)| [Some(wanted(i, j)), found(i, j)]).flatten();
    let low = heights().fold(f64::INFINITY, f64::min).min(0.0);
    let high = heights().fold(f64::NEG_INFINITY, f64::max);
    let range = |v: &[f64]| v[0]..v[v.len() - 1];
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .caption(format!("{}: {what}", surface.fit), ("sans-serif", 15))
        .build_cartesian_3d(range(&decades), low..high, range(ratios))?;
    chart.with_projection(|mut view: ProjectionMatrixBuilder| {
        (view.pitch, view.yaw, view.scale) = (0.35, 0.75, 0.8);
        view.into_matrix()
    });
    let short = |v: &f64| format!("{}", (v * 100.0).round() / 100.0);
    chart
        .configure_axes()
        .light_grid_style(WHITE)
        .bold_grid_style(BLACK.mix(0.15))
        .max_light_lines(1)
        .x_labels(4)
        .z_labels(5)
        .x_formatter(&short)
        .y_formatter(&short)
        .z_formatter(&short)
        .draw()?;
    for (asks, style) in [(true, BLACK.mix(0.3).stroke_width(1)), (false, RGBColor(213, 94, 0).stroke_width(1))] {
        let height = |i: usize, j: usize| if asks { Some(wanted(i, j)) } else { found(i, j) };
        let at = |(i, j): (usize, usize)| height(i, j).map(|h| (decades[i], h, ratios[j]));
        let along: Vec<Vec<_>> = (0..ratios.len()).map(|j| (0..decades.len()).map(|i| (i, j)).collect()).collect();
        let across: Vec<Vec<_>> = (0..decades.len()).map(|i| (0..ratios.len()).map(|j| (i, j)).collect()).collect();
        for line in along.into_iter().chain(across) {
            let known: Vec<(f64, f64, f64)> = line.into_iter().filter_map(at).collect();
            chart.draw_series(LineSeries::new(known, style))?;
        }
    }
    Ok(())
}
