//! Moduli of networks against the constants that were asked for.

use super::figure::COLORS;
use crate::error::{Error, Result};
use crate::study::Surface;
use plotters::coord::Shift;
use plotters::prelude::*;

/// Pixels of a panel, and of the title above and the names below.
const PANEL: (u32, u32) = (410, 330);
const TITLE: u32 = 30;
const NAMES: u32 = 34;

type Fallible = std::result::Result<(), Box<dyn std::error::Error>>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Two panels over `ν_in`: `E_out/E_in`, and `ν_out`. A network has a line for each `E_in`; they coincide where the moduli of the
/// network are in proportion. What was asked for is grey. An SVG file's text.
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

fn draw(text: &mut String, title: &str, surfaces: &[&Surface]) -> Fallible {
    let size = (2 * PANEL.0, TITLE + PANEL.1 + NAMES);
    let area = SVGBackend::with_string(text, size).into_drawing_area();
    area.fill(&WHITE)?;
    area.draw(&Text::new(title.to_string(), (12, 8), ("sans-serif", 16)))?;
    let (_, below) = area.split_vertically(TITLE);
    let (panels, names) = below.split_vertically(PANEL.1);
    let (left, right) = panels.split_horizontally(PANEL.0);
    panel(&left, surfaces, "E_out / E_in", &|_, _| 1.0, &|[young, _], asked| young / asked)?;
    panel(&right, surfaces, "nu_out", &|_, poisson| poisson, &|[_, poisson], _| poisson)?;
    let mut x = 20;
    let asked = std::iter::once(("asked for", GREY)).map(|(name, color)| (name.to_string(), color));
    for (name, color) in asked.chain(surfaces.iter().enumerate().map(|(i, s)| (s.fit.clone(), hue(i)))) {
        names.draw(&PathElement::new([(x, 14), (x + 22, 14)], color.stroke_width(3)))?;
        names.draw(&Text::new(name.clone(), (x + 28, 7), ("sans-serif", 14)))?;
        x += 44 + 8 * name.chars().count() as i32;
    }
    area.present()?;
    Ok(())
}

const GREY: RGBColor = RGBColor(165, 165, 165);

fn hue(i: usize) -> RGBColor {
    COLORS[[0, 1, 2, 5, 4, 3, 6, 7][i % 8]]
}

fn panel(
    area: &Area,
    surfaces: &[&Surface],
    what: &str,
    asked: &dyn Fn(f64, f64) -> f64,
    value: &dyn Fn([f64; 2], f64) -> f64,
) -> Fallible {
    let lines = |surface: &Surface| -> Vec<Vec<(f64, f64)>> {
        let of = |i: usize, young: f64| {
            let points =
                surface.poisson.iter().enumerate().filter_map(move |(j, &nu)| {
                    Some((nu, value(surface.found[i * surface.poisson.len() + j]?, young)))
                });
            points.filter(|(_, y)| y.is_finite()).collect()
        };
        surface.young.iter().enumerate().map(|(i, &young)| of(i, young)).collect()
    };
    let wanted: Vec<(f64, f64)> = surfaces[0].poisson.iter().map(|&nu| (nu, asked(1.0, nu))).collect();
    let all = || surfaces.iter().flat_map(|s| lines(s)).flatten().chain(wanted.iter().copied());
    let range = |of: fn((f64, f64)) -> f64| {
        let (a, b) = all().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let room = 0.05 * (b - a).max(0.02);
        a - room..b + room
    };
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .x_label_area_size(42)
        .y_label_area_size(60)
        .build_cartesian_2d(range(|p| p.0), range(|p| p.1))?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc("nu_in")
        .y_desc(what)
        .x_label_formatter(&short)
        .y_label_formatter(&short)
        .label_style(("sans-serif", 13))
        .draw()?;
    chart.draw_series(LineSeries::new(wanted.iter().copied(), GREY.stroke_width(5)))?;
    for (i, surface) in surfaces.iter().enumerate() {
        for line in lines(surface) {
            match i % 3 {
                0 => {
                    chart.draw_series(LineSeries::new(line, hue(i).stroke_width(2)))?;
                }
                k => {
                    let (on, off) = if k == 1 { (9, 4) } else { (3, 4) };
                    chart.draw_series(DashedLineSeries::new(line, on, off, hue(i).stroke_width(2)))?;
                }
            }
        }
    }
    Ok(())
}

fn short(v: &f64) -> String {
    format!("{}", (v * 1000.0).round() / 1000.0)
}
