//! The sheet of a figure: its width on the page, its title for readers of screens, its texts.

use crate::report::choice::choices;
use crate::text::printable;
use plotters::style::RGBColor;
use svg::Document;
use svg::node::element::{Path, Text, Title};

choices! {
    /// The width of a figure in a paper.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum Columns {
        /// 85 mm.
        #[default]
        One = "one",
        /// 178 mm.
        Two = "two",
    }
}

impl Columns {
    /// Millimetres across.
    pub(super) fn millimetres(self) -> u32 {
        match self {
            Columns::One => 85,
            Columns::Two => 178,
        }
    }

    /// Pixels across, 96 an inch.
    pub(in crate::report) fn pixels(self) -> u32 {
        // A pixel of CSS is 1/96 inch.
        (f64::from(self.millimetres()) * 96.0 / 25.4) as u32
    }
}

/// Pixels of letters of names and numbers.
pub(super) const LETTERS: u32 = 10;

/// A white sheet of this height in pixels.
pub(in crate::report) fn sheet(columns: Columns, height: f64, title: &str) -> Document {
    let width = columns.pixels();
    let tall = f64::from(columns.millimetres()) * height / f64::from(width);
    Document::new()
        .set("width", format!("{}mm", columns.millimetres()))
        .set("height", format!("{tall:.1}mm"))
        .set("viewBox", format!("0 0 {width} {height:.0}"))
        .set("role", "img")
        .set("font-family", "sans-serif")
        .add(Title::new(printable(title)))
        .add(Path::new().set("d", format!("M0,0H{width}V{height:.0}H0z")).set("fill", "white"))
}

/// Words at a place: `anchor` is `start`, `middle` or `end`.
pub(in crate::report) fn words(text: &str, [x, y]: [f64; 2], anchor: &str) -> Text {
    Text::new(printable(text))
        .set("x", tenth(x))
        .set("y", tenth(y))
        .set("text-anchor", anchor)
        .set("font-size", LETTERS)
}

/// Pixels that words are about as wide as.
pub(super) fn width(text: &str) -> f64 {
    5.8 * text.chars().count() as f64
}

/// A name that fits into so many pixels.
pub(super) fn cut(name: &str, room: f64) -> String {
    let most = (room / width("n")) as usize;
    match name.chars().count() > most {
        true => name.chars().take(most.saturating_sub(1)).chain(['…']).collect(),
        false => name.into(),
    }
}

/// A line through points on the sheet.
pub(super) fn line(points: &[[f64; 2]], color: RGBColor, width: f64, dashes: &[i32]) -> Path {
    let path = Path::new()
        .set("d", outline(points))
        .set("fill", "none")
        .set("stroke", super::palette::faded(color, 0.0))
        .set("stroke-width", width);
    let dashes: Vec<String> = dashes.iter().map(i32::to_string).collect();
    if dashes.is_empty() { path } else { path.set("stroke-dasharray", dashes.join(" ")) }
}

/// Points as the data of a path.
pub(super) fn outline(points: &[[f64; 2]]) -> String {
    let mut data = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        data += &format!("{}{},{}", if i == 0 { "M" } else { "L" }, tenth(*x), tenth(*y));
    }
    data
}

/// A hundredth of a pixel is not seen.
pub(super) fn tenth(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}
