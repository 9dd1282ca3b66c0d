//! A chart in the plane for a paper: axes fitted to the data, marks and lines that differ in colour, form and grey.

use crate::error::{Error, Result};
use crate::text::printable;
use clap::ValueEnum;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use std::ops::Range;

/// The width of a figure in a paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Columns {
    /// 85 mm.
    #[default]
    One,
    /// 178 mm.
    Two,
}

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What is measured, with its unit.
    pub title: String,
    /// Whether it is logarithmic where its values span a decade; values above zero alone are shown.
    pub is_log: bool,
}

/// How the points of a series are shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// As marks.
    Marks,
    /// As an open mark: the value is below the axis.
    Below,
    /// As a line.
    Line,
    /// As bars of this width.
    Bars(f64),
}

/// Points with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// Values along both axes.
    pub points: Vec<(f64, f64)>,
    /// How they are shown.
    pub shape: Shape,
}

/// A chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// For readers of screens, and above the chart.
    pub title: String,
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
    /// What is shown.
    pub series: Vec<Series>,
}

/// Okabe and Ito (2008): told apart by all eyes; in an order whose neighbours differ in grey.
const COLORS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
    RGBColor(86, 180, 233),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(120, 120, 120),
];
/// Pixels of a line of the legend, and of a character of its text.
const LINE: i32 = 15;
const CHARACTER: f64 = 6.2;

type Fallible = std::result::Result<(), Box<dyn std::error::Error>>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

impl Columns {
    /// Millimetres across.
    fn width(self) -> u32 {
        match self {
            Columns::One => 85,
            Columns::Two => 178,
        }
    }
}

impl Chart {
    /// The chart as an SVG file's text.
    ///
    /// # Errors
    /// Nothing can be shown.
    pub fn svg(&self, columns: Columns) -> Result<String> {
        let values = |axis: &Axis, value: &dyn Fn(&(f64, f64)) -> f64| -> Vec<f64> {
            let all = self.series.iter().flat_map(|series| series.points.iter().map(value));
            all.filter(|v| v.is_finite() && (*v > 0.0 || !axis.is_log)).collect()
        };
        let (xs, ys) = (values(&self.x, &|p| p.0), values(&self.y, &|p| p.1));
        if xs.is_empty() || ys.is_empty() {
            return Err(Error::new(format!("nothing to draw: {} has no values", printable(&self.title))));
        }
        let bars = self.series.iter().any(|series| matches!(series.shape, Shape::Bars(_)));
        let logs = [self.x.is_log && spans_decade(&xs), self.y.is_log && spans_decade(&ys)];
        let (x, mut y) = (fitted(&xs, logs[0]), fitted(&ys, logs[1]));
        if bars {
            y.start = 0.0;
        }
        // 96 pixels an inch.
        let width = (f64::from(columns.width()) * 96.0 / 25.4) as u32;
        let rows = self.legend(width as i32).last().map_or(0, |(row, ..)| row + 1);
        let height = (0.72 * f64::from(width.min(440))) as u32 + (LINE * rows) as u32;
        let mut text = String::new();
        self.draw(&mut text, (width, height), x, y, logs)
            .map_err(|e| Error::new(format!("the figure cannot be drawn: {e}")))?;
        Ok(titled(&text, &self.title, columns.width(), (width, height)))
    }

    fn draw(&self, text: &mut String, size: (u32, u32), x: Range<f64>, y: Range<f64>, logs: [bool; 2]) -> Fallible {
        let area = SVGBackend::with_string(text, size).into_drawing_area();
        area.fill(&WHITE)?;
        let legend = self.legend(size.0 as i32);
        let rows = legend.last().map_or(0, |(row, ..)| row + 1);
        let (plot, names) = area.split_vertically(size.1 as i32 - LINE * rows - 4);
        match logs.into() {
            (true, true) => self.panel(&plot, x.log_scale(), y.log_scale())?,
            (true, false) => self.panel(&plot, x.log_scale(), y)?,
            (false, true) => self.panel(&plot, x, y.log_scale())?,
            (false, false) => self.panel(&plot, x, y)?,
        }
        for (row, left, series) in legend {
            self.name(&names, series, (left, LINE * row))?;
        }
        area.present()?;
        Ok(())
    }

    fn panel<X, Y>(&self, area: &Area, x: X, y: Y) -> Fallible
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: ValueFormatter<f64>,
        Y::CoordDescType: ValueFormatter<f64>,
    {
        let mut chart = ChartBuilder::on(area)
            .margin(6)
            .margin_right(14)
            .x_label_area_size(36)
            .y_label_area_size(52)
            .build_cartesian_2d(x, y)?;
        let grey = BLACK.mix(0.12);
        chart
            .configure_mesh()
            .light_line_style(WHITE.mix(0.0))
            .bold_line_style(grey)
            .axis_style(BLACK.mix(0.6))
            .x_labels(6)
            .y_labels(6)
            .x_desc(printable(&self.x.title))
            .y_desc(printable(&self.y.title))
            .x_label_formatter(&number)
            .y_label_formatter(&number)
            .label_style(("sans-serif", 11))
            .axis_desc_style(("sans-serif", 12))
            .draw()?;
        for (i, series) in self.series.iter().enumerate() {
            let color = COLORS[i % COLORS.len()];
            match series.shape {
                Shape::Bars(width) => {
                    let bar = |(x, y): &(f64, f64)| {
                        Rectangle::new([(x - width / 2.0, 0.0), (x + width / 2.0, *y)], color.filled())
                    };
                    chart.draw_series(series.points.iter().map(bar))?;
                }
                Shape::Line => match i % 4 {
                    0 => {
                        chart.draw_series(LineSeries::new(series.points.iter().copied(), color.stroke_width(2)))?;
                    }
                    k => {
                        let (on, off) = [(8, 3), (3, 3), (12, 5)][k - 1];
                        let points = series.points.iter().copied();
                        chart.draw_series(DashedLineSeries::new(points, on, off, color.stroke_width(2)))?;
                    }
                },
                Shape::Marks | Shape::Below => {
                    for point in &series.points {
                        match mark(i, series.shape) {
                            Mark::Disc => chart.draw_series([Circle::new(*point, 4, color.filled())])?,
                            Mark::Ring => chart.draw_series([Circle::new(*point, 4, color.stroke_width(2))])?,
                            Mark::Triangle => chart.draw_series([TriangleMarker::new(*point, 5, color.filled())])?,
                            Mark::Cross => chart.draw_series([Cross::new(*point, 4, color.stroke_width(2))])?,
                            Mark::Open => {
                                chart.draw_series([TriangleMarker::new(*point, -5, color.stroke_width(1))])?
                            }
                        };
                    }
                }
            }
        }
        Ok(())
    }

    /// The row and the left end of each name, and its place among the series.
    fn legend(&self, width: i32) -> Vec<(i32, i32, usize)> {
        if self.series.len() < 2 {
            return Vec::new();
        }
        let (mut row, mut left) = (0, 8);
        let place = |(i, series): (usize, &Series)| {
            let own = 24 + (CHARACTER * series.name.chars().count() as f64) as i32 + 14;
            if left > 8 && left + own > width {
                (row, left) = (row + 1, 8);
            }
            let found = (row, left, i);
            left += own;
            found
        };
        self.series.iter().enumerate().map(place).collect()
    }

    fn name(&self, area: &Area, i: usize, (left, top): (i32, i32)) -> Fallible {
        let (series, color, at) = (&self.series[i], COLORS[i % COLORS.len()], (left + 9, top + 6));
        match series.shape {
            Shape::Bars(_) => {
                area.draw(&Rectangle::new([(left + 3, top + 1), (left + 15, top + 11)], color.filled()))?
            }
            Shape::Line => {
                let ends = [(left, at.1), (left + 18, at.1)];
                match i % 4 {
                    0 => area.draw(&PathElement::new(ends, color.stroke_width(2)))?,
                    _ => {
                        for from in [left, left + 7, left + 14] {
                            area.draw(&PathElement::new([(from, at.1), (from + 4, at.1)], color.stroke_width(2)))?;
                        }
                    }
                }
            }
            Shape::Marks | Shape::Below => match mark(i, series.shape) {
                Mark::Disc => area.draw(&Circle::new(at, 4, color.filled()))?,
                Mark::Ring => area.draw(&Circle::new(at, 4, color.stroke_width(2)))?,
                Mark::Triangle => area.draw(&TriangleMarker::new(at, 5, color.filled()))?,
                Mark::Cross => area.draw(&Cross::new(at, 4, color.stroke_width(2)))?,
                Mark::Open => area.draw(&TriangleMarker::new(at, -5, color.stroke_width(1)))?,
            },
        }
        area.draw(&Text::new(printable(&series.name).into_owned(), (left + 24, top), ("sans-serif", 11)))?;
        Ok(())
    }
}

#[derive(Clone, Copy)]
enum Mark {
    Disc,
    Ring,
    Triangle,
    Cross,
    Open,
}

/// The mark of a series: those of the same colour differ.
fn mark(i: usize, shape: Shape) -> Mark {
    match shape {
        Shape::Below => Mark::Open,
        Shape::Marks | Shape::Line | Shape::Bars(_) => {
            [Mark::Disc, Mark::Triangle, Mark::Cross, Mark::Ring][(i + i / COLORS.len()) % 4]
        }
    }
}

/// Whether a logarithmic axis has two powers of ten to be marked.
fn spans_decade(values: &[f64]) -> bool {
    let power = |v: f64| v.log10().floor();
    let (least, largest) = values.iter().fold((f64::INFINITY, 0.0f64), |(a, b), v| (a.min(*v), b.max(*v)));
    power(1.3 * largest) - power(least / 1.3) >= 2.0
}

/// The range of the values with some room on both sides.
fn fitted(values: &[f64], is_log: bool) -> Range<f64> {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if is_log {
        let room = (largest / least).powf(0.06).max(1.3);
        return least / room..largest * room;
    }
    let room = 0.05 * (largest - least).max(1e-9 * largest.abs()).max(f64::MIN_POSITIVE);
    least - room..largest + room
}

/// The number as it is written at an axis.
fn number(v: &f64) -> String {
    match v.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => format!("{}", (v * 1e6).round() / 1e6),
        _ => format!("{v:.0e}"),
    }
}

/// The width in millimetres, and a title, in place of the library's first tag.
fn titled(svg: &str, title: &str, millimetres: u32, (width, height): (u32, u32)) -> String {
    let begin = svg.find("<svg").unwrap_or(0);
    let rest = svg[begin..].split_once('>').map_or("", |(_, rest)| rest);
    let tall = f64::from(millimetres) * f64::from(height) / f64::from(width);
    let title = printable(title).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    format!(
        "<svg width=\"{millimetres}mm\" height=\"{tall:.1}mm\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         xmlns=\"http://www.w3.org/2000/svg\">\n<title>{title}</title>{rest}"
    )
}
