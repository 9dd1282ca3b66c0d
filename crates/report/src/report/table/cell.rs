//! A cell of a table.

use super::Column;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is shown where nothing is known.
const UNKNOWN: &str = "–";

/// A cell: what it shows, and the number behind it, by which rows are sorted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cell {
    /// The cell shows this text, and `–` where nothing is known.
    pub text: String,
    /// The number is null for words, and where nothing is known.
    pub value: Option<f64>,
    /// The number is the best of its group, which typeset tables show in bold.
    #[serde(skip)]
    pub is_best: bool,
}

/// How a number is written.
#[derive(Debug, Clone, Copy)]
pub(in crate::report) enum Digits {
    /// The number is written with this number of digits behind the point.
    Fixed(usize),
    /// The number is written with its sign and this number of digits behind the point.
    Signed(usize),
    /// The number is written with this number of digits in all.
    Significant(usize),
}

impl Cell {
    /// A number, where it is known.
    pub(in crate::report) fn number(value: Option<f64>, digits: Digits) -> Cell {
        let value = value.filter(|value| value.is_finite());
        Cell { text: value.map_or(UNKNOWN.into(), |value| digits.text(value)), value, is_best: false }
    }

    /// A share, in percent.
    pub(in crate::report) fn percent(share: Option<f64>, digits: Digits) -> Cell {
        Cell::number(share.map(|share| 100.0 * share), digits)
    }

    /// Puts a mark behind the text of the cell.
    pub(in crate::report) fn marked(self, mark: &str) -> Cell {
        Cell { text: self.text + mark, ..self }
    }

    /// Says whether the number is the best of its group.
    pub(in crate::report) fn best(self, is_best: bool) -> Cell {
        Cell { is_best, ..self }
    }

    /// Puts the cell into this column: texts of a column of numbers are read as numbers.
    pub(super) fn of(self, column: &Column) -> Cell {
        let value =
            self.value.or_else(|| self.text.parse().ok().filter(|value: &f64| column.numbers && value.is_finite()));
        Cell { value, ..self }
    }

    /// Nothing is known of it.
    pub(super) fn is_unknown(&self) -> bool {
        self.text == UNKNOWN
    }

    /// The text in ASCII, if nothing is known.
    pub(super) fn plain(&self) -> &str {
        if self.is_unknown() { "-" } else { &self.text }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Cell {
        Cell { text: if text == "-" { UNKNOWN.into() } else { text }, value: None, is_best: false }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Cell {
        text.to_string().into()
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Cell {
        Cell { text: count.to_string(), value: Some(count as f64), is_best: false }
    }
}

impl Digits {
    fn text(self, value: f64) -> String {
        match self {
            Digits::Fixed(places) => unsigned_zero(format!("{value:.places$}")),
            Digits::Signed(places) => unsigned_zero(format!("{value:+.places$}")),
            Digits::Significant(count) => significant(value, count),
        }
    }
}

/// A zero without a sign.
fn unsigned_zero(text: String) -> String {
    match text.strip_prefix(['+', '-']) {
        Some(digits) if digits.chars().all(|c| c == '0' || c == '.') => digits.into(),
        _ => text,
    }
}

/// A number with so many digits; beyond six places before or four zeros behind the point with its power of ten.
fn significant(value: f64, digits: usize) -> String {
    let scientific = format!("{value:.*e}", digits - 1);
    // The power of ten of the rounded number: 9.9999 with four digits is 10.00.
    let power = scientific.rsplit('e').next().and_then(|power| power.parse::<i32>().ok());
    match power {
        Some(power @ -4..6) => format!("{value:.*}", (digits as i32 - 1 - power).max(0) as usize),
        _ => scientific,
    }
}
