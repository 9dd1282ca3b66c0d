//! A chart in the plane for a paper: axes fitted to the data, marks and lines that differ in colour, form and grey.

use super::axis::{Axis, log_marks, number};
use super::marks::{FINE, MARK, Mark, THICK, THIN, diamond, mark, open, pane, plus, square};
use super::palette::{COLORS, DASHES, REFERENCE};
use super::sheet::{Columns, LETTERS, cut, width};
use crate::error::{Error, Result};
use crate::text::{printable, xml};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// How the points of a series are shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// The points are shown as marks.
    Marks,
    /// The points are shown as open marks: their values are below the axis.
    Below,
    /// The points are shown as a line.
    Line,
    /// The points are shown as a line with marks.
    Curve,
    /// The points are shown as a thin grey line with its name at its last point, for comparison; no place is made for it. One point has the name alone, above.
    Guide,
    /// The points are shown as bars of this width.
    Bars(f64),
    /// The points are shown as small marks.
    Dots,
    /// Each two points are the ends of a thin line in the colour of the series before.
    Whiskers,
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
    /// Its place among colours, dashes and marks, so that a model looks the same in all figures; `None` takes them in the order of the series.
    pub style: Option<usize>,
}

impl Series {
    /// A series that looks as its place in the chart says.
    pub fn new(name: impl Into<String>, points: Vec<(f64, f64)>, shape: Shape) -> Series {
        Series { name: name.into(), points, shape, style: None }
    }

    /// The series with the look of this place.
    pub fn styled(self, place: usize) -> Series {
        Series { style: Some(place), ..self }
    }

    /// Whether the legend has its name.
    fn is_named(&self) -> bool {
        !matches!(self.shape, Shape::Guide | Shape::Whiskers)
    }
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

/// Units of a line of the legend.
const LINE: i32 = 15 * FINE;
/// Units from the middle of a dot to its edge.
const DOT: i32 = 3 * FINE / 2;
/// Units of letters, as the drawing library counts them.
const FONT: i32 = FINE * LETTERS as i32 * 5 / 4;

/// Units around a panel, at its right end, and of the numbers and titles below it and at its left.
// At the right half of the last number stands beyond the axis; below there are a line of numbers and one of the title; at the left there
// are numbers of up to six digits beside a title that is turned.
const EDGE: i32 = 6 * FINE;
const RIGHT: i32 = 14 * FINE;
const UNDER: i32 = 36 * FINE;
const LEFT: i32 = 52 * FINE;
/// Units of an axis that a title cannot have: across, and up.
const BESIDE: i32 = LEFT + EDGE + RIGHT;
const BELOW: i32 = UNDER + 2 * EDGE;
/// Letters of an axis' title are not smaller than this share of the others: they would be hard to read, and the title is cut instead.
const SMALLEST: f64 = 0.75;

/// Values that an axis has at most: its marks are counted in powers of ten.
const LARGEST: f64 = 1e60;

type Fallible = std::result::Result<(), Box<dyn std::error::Error>>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

impl Chart {
    /// The chart as an SVG file's text.
    ///
    /// # Errors
    /// Nothing can be shown.
    pub fn svg(&self, columns: Columns) -> Result<String> {
        let own = || self.series.iter().filter(|series| series.shape != Shape::Guide);
        let values = |axis: &Axis, value: &dyn Fn(&(f64, f64)) -> f64| -> Vec<f64> {
            let all = own().flat_map(|series| series.points.iter().map(value));
            all.filter(|v| v.is_finite() && (*v > 0.0 || !axis.is_log)).collect()
        };
        let (xs, ys) = (values(&self.x, &|p| p.0), values(&self.y, &|p| p.1));
        if xs.is_empty() || ys.is_empty() {
            return Err(Error::new(format!("nothing to draw: {} has no values", printable(&self.title))));
        }
        let bars = self.series.iter().any(|series| matches!(series.shape, Shape::Bars(_)));
        let (x, mut y) = (self.x.range(&xs), self.y.range(&ys));
        for (axis, range) in [(&self.x, &x), (&self.y, &y)] {
            if !(range.end < LARGEST && range.start > -LARGEST) || axis.is_log && range.start < 1.0 / LARGEST {
                let words = format!("{} has values beyond {LARGEST:e}", printable(&axis.title));
                return Err(Error::new(format!("the figure cannot be drawn: {words}")));
            }
        }
        // The length of a bar is its value: it begins at zero.
        if bars {
            y.start = 0.0;
        }
        let width = columns.pixels() * FINE as u32;
        let rows = self.legend(width as i32).last().map_or(0, |(row, ..)| row + 1);
        let height = (0.72 * f64::from(width.min(440 * FINE as u32))) as u32 + (LINE * rows) as u32;
        let mut text = String::new();
        self.draw(&mut text, (width, height), x, y)
            .map_err(|e| Error::new(format!("the figure cannot be drawn: {e}")))?;
        Ok(titled(&text, &self.title, columns.millimetres(), (width, height)))
    }

    fn draw(&self, text: &mut String, size: (u32, u32), x: Range<f64>, y: Range<f64>) -> Fallible {
        let area = SVGBackend::with_string(text, size).into_drawing_area();
        area.fill(&WHITE)?;
        let legend = self.legend(size.0 as i32);
        let rows = legend.last().map_or(0, |(row, ..)| row + 1);
        let (plot, names) = area.split_vertically(size.1 as i32 - LINE * rows - 4 * FINE);
        let marked = |range: Range<f64>| {
            let marks = log_marks(&range);
            range.log_scale().with_key_points(marks)
        };
        match (self.x.is_log, self.y.is_log) {
            (true, true) => self.panel(&plot, marked(x), marked(y))?,
            (true, false) => self.panel(&plot, marked(x), y)?,
            (false, true) => self.panel(&plot, x, marked(y))?,
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
            .margin(EDGE)
            .margin_right(RIGHT)
            .x_label_area_size(UNDER)
            .y_label_area_size(LEFT)
            .build_cartesian_2d(x, y)?;
        let grey = BLACK.mix(0.12);
        let (wide, tall) = area.dim_in_pixel();
        let rooms = [wide as i32 - BESIDE, tall as i32 - BELOW];
        let titles = [&self.x.title, &self.y.title];
        // Titles that are longer than their axis have smaller letters, and beyond that an end.
        let needed =
            titles.iter().zip(rooms).map(|(title, room)| f64::from(room) / (self::width(title) * f64::from(FINE)));
        let share = needed.fold(1.0, f64::min).max(SMALLEST);
        let [across, up] = [0, 1].map(|k| cut(&printable(titles[k]), f64::from(rooms[k]) / f64::from(FINE) / share));
        chart
            .configure_mesh()
            .light_line_style(WHITE.mix(0.0))
            .bold_line_style(grey.stroke_width(FINE as u32 * 3 / 4))
            .axis_style(BLACK.mix(0.6).stroke_width(FINE as u32))
            .set_all_tick_mark_size(4 * FINE)
            .x_labels(6)
            .y_labels(6)
            .x_desc(across)
            .y_desc(up)
            .x_label_formatter(&number)
            .y_label_formatter(&number)
            .label_style(("sans-serif", FONT))
            .axis_desc_style(("sans-serif", f64::from(FONT) * share))
            .draw()?;
        for (place, series) in self.series.iter().enumerate() {
            let i = self.style(place);
            let color = COLORS[i % COLORS.len()];
            match series.shape {
                Shape::Dots => {
                    let points = || series.points.iter().copied();
                    let (full, line) = (color.mix(0.7).filled(), color.mix(0.8).stroke_width(THIN / 2));
                    match i % DOTS {
                        0 => chart.draw_series(points().map(|at| Circle::new(at, DOT, full)))?,
                        1 => chart.draw_series(points().map(|at| TriangleMarker::new(at, DOT + FINE / 2, full)))?,
                        2 => chart.draw_series(points().map(|at| Cross::new(at, DOT, line)))?,
                        _ => chart.draw_series(points().map(|at| Circle::new(at, DOT, line)))?,
                    };
                }
                Shape::Whiskers => {
                    for ends in series.points.chunks_exact(2) {
                        chart.draw_series(LineSeries::new(ends.iter().copied(), color.stroke_width(THIN)))?;
                    }
                }
                Shape::Bars(width) => {
                    let bar = |(x, y): &(f64, f64)| {
                        Rectangle::new([(x - width / 2.0, 0.0), (x + width / 2.0, *y)], color.filled())
                    };
                    chart.draw_series(series.points.iter().map(bar))?;
                }
                Shape::Line | Shape::Curve => match DASHES[i % DASHES.len()] {
                    [on, off, ..] => {
                        let points = series.points.iter().copied();
                        chart.draw_series(DashedLineSeries::new(
                            points,
                            *on * FINE,
                            *off * FINE,
                            color.stroke_width(THICK),
                        ))?;
                    }
                    _ => {
                        chart.draw_series(LineSeries::new(series.points.iter().copied(), color.stroke_width(THICK)))?;
                    }
                },
                Shape::Guide => {
                    let points = series.points.iter().copied();
                    chart.draw_series(DashedLineSeries::new(
                        points,
                        4 * FINE,
                        4 * FINE,
                        REFERENCE.stroke_width(THIN),
                    ))?;
                    let at = series.points.last().copied().into_iter();
                    let font = ("sans-serif", FONT - FINE).into_font().color(&GUIDE);
                    // A name without a line stands on its point.
                    let side = if series.points.len() == 1 { VPos::Bottom } else { VPos::Top };
                    let font = font.pos(Pos::new(HPos::Left, side));
                    let name = |at| Text::new(series.name.clone(), at, font.clone());
                    chart.draw_series(at.map(name))?;
                }
                Shape::Marks | Shape::Below => {}
            }
            if matches!(series.shape, Shape::Marks | Shape::Below | Shape::Curve) {
                for point in &series.points {
                    match mark(i, series.shape == Shape::Below) {
                        Mark::Disc => chart.draw_series([Circle::new(*point, MARK, color.filled())])?,
                        Mark::Ring => chart.draw_series([Circle::new(*point, MARK, color.stroke_width(THICK))])?,
                        Mark::Triangle => {
                            chart.draw_series([TriangleMarker::new(*point, MARK + FINE, color.filled())])?
                        }
                        Mark::Cross => chart.draw_series([Cross::new(*point, MARK, color.stroke_width(THICK))])?,
                        Mark::Open => chart.draw_series([EmptyElement::at(*point) + open(color)])?,
                        Mark::Square => chart.draw_series([EmptyElement::at(*point) + square(color)])?,
                        Mark::Diamond => chart.draw_series([EmptyElement::at(*point) + diamond(color)])?,
                        Mark::Plus => chart.draw_series([EmptyElement::at(*point) + plus(color)])?,
                        Mark::Pane => chart.draw_series([EmptyElement::at(*point) + pane(color)])?,
                    };
                }
            }
        }
        Ok(())
    }

    /// The place of a series among those that differ in colour, dashes and marks.
    fn style(&self, place: usize) -> usize {
        let is_own = |series: &Series| series.shape != Shape::Whiskers;
        // Whiskers belong to the series before.
        let own = self.series[..=place].iter().rposition(is_own).unwrap_or(0);
        let others = self.series[..=own].iter().filter(|series| is_own(series)).count();
        self.series[own].style.unwrap_or(others.saturating_sub(1))
    }

    /// The row and the left end of each name, and its place among the series.
    fn legend(&self, width: i32) -> Vec<(i32, i32, usize)> {
        let named = || self.series.iter().enumerate().filter(|(_, series)| series.is_named());
        // A single series needs no name to be told from others.
        if named().count() < 2 {
            return Vec::new();
        }
        let (mut row, mut left) = (0, 8 * FINE);
        let place = |(i, series): (usize, &Series)| {
            let own = (24 + self::width(&legend_name(&series.name, width)) as i32 + 14) * FINE;
            if left > 8 * FINE && left + own > width {
                (row, left) = (row + 1, 8 * FINE);
            }
            let found = (row, left, i);
            left += own;
            found
        };
        named().map(place).collect()
    }

    fn name(&self, area: &Area, i: usize, (left, top): (i32, i32)) -> Fallible {
        let (series, i) = (&self.series[i], self.style(i));
        let (color, at) = (COLORS[i % COLORS.len()], (left + 9 * FINE, top + 6 * FINE));
        match series.shape {
            Shape::Bars(_) => area.draw(&Rectangle::new(
                [(left + 3 * FINE, top + FINE), (left + 15 * FINE, top + 11 * FINE)],
                color.filled(),
            ))?,
            Shape::Line | Shape::Curve | Shape::Guide => match DASHES[i % DASHES.len()] {
                [] => area
                    .draw(&PathElement::new([(left, at.1), (left + SAMPLE * FINE, at.1)], color.stroke_width(THICK)))?,
                dashes => {
                    let (on, both) = (dashes[0], dashes[0] + dashes[1]);
                    for from in (0..SAMPLE).step_by(both as usize) {
                        let ends = [from, (from + on).min(SAMPLE)].map(|x| (left + x * FINE, at.1));
                        area.draw(&PathElement::new(ends, color.stroke_width(THICK)))?;
                    }
                }
            },
            Shape::Dots => match i % DOTS {
                0 => area.draw(&Circle::new(at, 2 * DOT, color.filled()))?,
                1 => area.draw(&TriangleMarker::new(at, 2 * DOT + FINE / 2, color.filled()))?,
                2 => area.draw(&Cross::new(at, 2 * DOT, color.stroke_width(THIN)))?,
                _ => area.draw(&Circle::new(at, 2 * DOT, color.stroke_width(THIN)))?,
            },
            Shape::Marks | Shape::Below | Shape::Whiskers => {}
        }
        if matches!(series.shape, Shape::Marks | Shape::Below | Shape::Curve) {
            match mark(i, series.shape == Shape::Below) {
                Mark::Disc => area.draw(&Circle::new(at, MARK, color.filled()))?,
                Mark::Ring => area.draw(&Circle::new(at, MARK, color.stroke_width(THICK)))?,
                Mark::Triangle => area.draw(&TriangleMarker::new(at, MARK + FINE, color.filled()))?,
                Mark::Cross => area.draw(&Cross::new(at, MARK, color.stroke_width(THICK)))?,
                Mark::Open => area.draw(&(EmptyElement::at(at) + open(color)))?,
                Mark::Square => area.draw(&(EmptyElement::at(at) + square(color)))?,
                Mark::Diamond => area.draw(&(EmptyElement::at(at) + diamond(color)))?,
                Mark::Plus => area.draw(&(EmptyElement::at(at) + plus(color)))?,
                Mark::Pane => area.draw(&(EmptyElement::at(at) + pane(color)))?,
            }
        }
        let shown = legend_name(&series.name, area.dim_in_pixel().0 as i32);
        area.draw(&Text::new(shown, (left + 24 * FINE, top), ("sans-serif", FONT)))?;
        Ok(())
    }
}

/// A name as the legend has it in a figure of this width in units.
fn legend_name(name: &str, width: i32) -> String {
    cut(&printable(name), f64::from(width / FINE - 8 - 24 - 4))
}

/// Small marks that differ in form.
const DOTS: usize = 4;
/// The length of a line in the legend, pixels.
const SAMPLE: i32 = 18;
/// The names of guides have this colour.
const GUIDE: RGBColor = RGBColor(110, 110, 110);

/// Charts one above the other, as one SVG file's text.
///
/// # Errors
/// A chart shows nothing.
pub fn stacked(title: &str, charts: &[Chart], columns: Columns) -> Result<String> {
    let drawn: Vec<String> = charts.iter().map(|chart| chart.svg(columns)).collect::<Result<_>>()?;
    let height = |svg: &str| -> f64 {
        let size = svg.split_once("viewBox=\"0 0 ").and_then(|(_, rest)| rest.split_once('"')?.0.split_once(' '));
        size.and_then(|(_, height)| height.parse().ok()).unwrap_or(0.0)
    };
    let width = columns.pixels() * FINE as u32;
    let (mut text, mut top) = (String::new(), 0.0);
    for svg in &drawn {
        let own = height(svg);
        let place = format!("<svg y=\"{top}\" width=\"{width}\" height=\"{own}\" viewBox");
        text += &svg.split_once("viewBox").map_or(String::new(), |(_, rest)| format!("{place}{rest}"));
        top += own;
    }
    Ok(titled(&format!("<svg>{text}</svg>\n"), title, columns.millimetres(), (width, top as u32)))
}

/// The width in millimetres, and a title, in place of the library's first tag.
fn titled(svg: &str, title: &str, millimetres: u32, (width, height): (u32, u32)) -> String {
    let begin = svg.find("<svg").unwrap_or(0);
    let rest = svg[begin..].split_once('>').map_or("", |(_, rest)| rest);
    let tall = f64::from(millimetres) * f64::from(height) / f64::from(width);
    let title = xml(title);
    format!(
        "<svg width=\"{millimetres}mm\" height=\"{tall:.1}mm\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         xmlns=\"http://www.w3.org/2000/svg\">\n<title>{title}</title>{rest}"
    )
}
