//! Errors of fits against their times.

use super::axis::Axis;
use super::chart::{Chart, Series, Shape};

/// Decades below the largest error within which errors are shown: an exact network has errors of rounding.
const DECADES: f64 = 4.0;
/// Smaller errors have a mark that is so many times below the least that is shown.
const BELOW: f64 = 3.0;

/// A mark for each fit: its name, the seconds of an element, and its error. An error that is too small for the axis is an open mark
/// under the others, with its number in the legend.
pub fn precision_chart(title: String, error: String, points: &[(String, f64, f64)]) -> Chart {
    let largest = points.iter().map(|(_, _, error)| *error).fold(0.0, f64::max);
    let least = largest * 10f64.powf(-DECADES);
    let shown = points.iter().map(|(_, _, error)| *error).filter(|error| *error >= least).fold(largest, f64::min);
    let unit = if error.ends_with('%') { " %" } else { "" };
    let series = |(name, seconds, error): &(String, f64, f64)| {
        let is_below = *error < least;
        let name = if is_below { format!("{name} ({error:.0e}{unit})") } else { name.clone() };
        let shape = if is_below { Shape::Below } else { Shape::Marks };
        Series { name, points: vec![(1e6 * seconds, error.max(shown / BELOW))], shape }
    };
    Chart {
        title,
        x: Axis::log("time to fit, µs per element"),
        y: Axis::log(error),
        series: points.iter().map(series).collect(),
    }
}
