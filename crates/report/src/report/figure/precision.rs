//! Errors of fits against their times.

use super::axis::Axis;
use super::chart::{Chart, Series, Shape};
use crate::report::choice::choices;
use crate::study::ModelTimes;

/// Decades below the largest error within which errors are shown: an exact network has errors of rounding.
const DECADES: f64 = 4.0;
/// Smaller errors have a mark that is so many times below the least that is shown.
pub(super) const BELOW: f64 = 3.0;

choices! {
    /// What a figure of errors against times has across.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum Cost {
        /// The time to fit the constants of an element
        #[default]
        Fit = "fit",
        /// The time of a solution with the network
        Solve = "solve",
        /// The time of an explicit step
        ExplicitStep = "explicit-step" | "step",
        /// The time of an implicit step
        ImplicitStep = "implicit-step",
        /// The time of a second of motion: in explicit steps, and of a network for an engine in the steps of that engine
        Second = "second",
    }
}

impl Cost {
    /// The unit, and how many of it are a second.
    fn unit(self) -> (&'static str, f64) {
        match self {
            Cost::Fit => ("µs per element", 1e6),
            Cost::Solve | Cost::ImplicitStep => ("ms", 1e3),
            Cost::ExplicitStep => ("µs", 1e6),
            Cost::Second => ("s", 1.0),
        }
    }

    /// The name of the time in a comparison, its unit, and how many of it are a second.
    pub fn of_comparison(self) -> (&'static str, &'static str, f64) {
        let kind = match self {
            Cost::Fit => "fit",
            Cost::Solve => "solve",
            Cost::ExplicitStep => "explicit-step",
            Cost::ImplicitStep => "implicit-step",
            Cost::Second => "simulated-second",
        };
        let (unit, per_second) = self.unit();
        (kind, unit, per_second)
    }

    /// What took the time.
    pub fn words(self) -> &'static str {
        match self {
            Cost::Fit => "to fit",
            Cost::Solve => "of a solution",
            Cost::ExplicitStep => "of an explicit step",
            Cost::ImplicitStep => "of an implicit step",
            Cost::Second => "of a simulated second",
        }
    }

    /// The median cost of a model, s; `None` of one that it does not have.
    pub fn of_model(self, times: &ModelTimes) -> Option<f64> {
        let times = match self {
            Cost::Fit => None,
            Cost::Solve => times.solve.as_ref(),
            Cost::ExplicitStep => times.explicit_step.as_ref(),
            Cost::ImplicitStep => times.implicit_step.as_ref(),
            Cost::Second => times.simulated_second.as_ref(),
        };
        Some(times?.median)
    }
}

/// A mark for each fit: its place in the run, its name, its cost in s, and its error. An error that is too small for the axis is an open mark under the others,
/// with its number in the legend. `kind` says of what passes the times are.
pub fn precision_chart(
    title: String,
    error: String,
    (cost, kind): (Cost, &str),
    points: &[(usize, String, f64, f64)],
) -> Chart {
    let (unit, per_second) = cost.unit();
    let largest = points.iter().map(|(.., error)| *error).fold(0.0, f64::max);
    let least = largest * 10f64.powf(-DECADES);
    // Marks of smaller errors stand below the least error that is shown, not at the end of the decades, so that no room
    // is left empty.
    let shown = points.iter().map(|(.., error)| *error).filter(|error| *error >= least).fold(largest, f64::min);
    let percent = if error.ends_with('%') { " %" } else { "" };
    let series = |(place, name, seconds, error): &(usize, String, f64, f64)| {
        let is_below = *error < least;
        let name = match (is_below, *error) {
            (true, 0.0) => format!("{name} (reference)"),
            (true, error) => format!("{name} ({error:.0e}{percent})"),
            (false, _) => name.clone(),
        };
        let shape = if is_below { Shape::Below } else { Shape::Marks };
        Series::new(name, vec![(per_second * seconds, error.max(shown / BELOW))], shape).styled(*place)
    };
    Chart {
        title,
        x: Axis::log(format!("processor time {}, {unit}{kind}", cost.words())),
        y: Axis::log(error),
        series: points.iter().map(series).collect(),
    }
}
