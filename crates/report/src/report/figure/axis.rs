//! Axes fitted to values, and the numbers at them.

use std::ops::Range;

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What is measured, with its unit.
    pub title: String,
    /// Whether it is logarithmic; values above zero alone are shown.
    pub is_log: bool,
}

impl Axis {
    /// With equal steps.
    pub fn linear(title: impl Into<String>) -> Axis {
        Axis { title: title.into(), is_log: false }
    }

    /// With equal factors.
    pub fn log(title: impl Into<String>) -> Axis {
        Axis { title: title.into(), is_log: true }
    }

    /// The range of the values with some room on both sides.
    pub(super) fn range(&self, values: &[f64]) -> Range<f64> {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if self.is_log {
            let room = (largest / least).powf(0.06).max(1.2);
            return least / room..largest * room;
        }
        // Values that are all equal, or all zero, have an axis of some width as well.
        let room = 0.05 * (largest - least).max(1e-9 * largest.abs()).max(f64::MIN_POSITIVE);
        least - room..largest + room
    }
}

/// Where a logarithmic axis is marked: at powers of ten, in a range of less than two also between them.
pub(super) fn log_marks(range: &Range<f64>) -> Vec<f64> {
    let decades = range.start.log10().floor() as i32..=range.end.log10().ceil() as i32;
    let steps: &[f64] = match (range.end / range.start).log10() {
        span if span < 0.35 => &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
        span if span < 0.9 => &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0],
        span if span < 2.0 => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    let all = decades.flat_map(|power| steps.iter().map(move |step| step * 10f64.powi(power)));
    let marks: Vec<f64> = all.filter(|mark| range.contains(mark)).collect();
    // More would not be read.
    let every = marks.len().div_ceil(8).max(1);
    marks.into_iter().step_by(every).collect()
}

/// Two to five steps of 1, 2 or 5 times a power of ten from zero to `largest`, without zero.
pub(super) fn rings(largest: f64) -> Vec<f64> {
    let rough = largest / 3.0;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|step| step * power).into_iter().find(|step| *step >= rough).unwrap_or(rough);
    // The last ring may be beyond the largest value by rounding.
    (1..=10).map(|i| f64::from(i) * step).take_while(|ring| *ring <= largest * 1.0001).collect()
}

/// The number as it is written at an axis.
pub(super) fn number(v: &f64) -> String {
    match v.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => format!("{}", (v * 1e6).round() / 1e6),
        _ => format!("{v:.0e}"),
    }
}

/// The power of a thousand with which a value is easily read: its factor, and its prefix of the SI.
pub(super) fn prefix(value: f64) -> (f64, &'static str) {
    let prefixes = [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ")];
    // A value that is written as 1000 with its digits has the next prefix.
    prefixes.into_iter().find(|(factor, _)| value.abs() >= *factor * 0.9995).unwrap_or((1e-9, "n"))
}
