//! Intervals by resampling: the percentile bootstrap of Efron (1979), The Annals of Statistics 7.

use super::quantile::{median, quantile};
use crate::random::Random;
use serde::Serialize;

/// The number of resamples. Ends of an interval of 95 % are then those of 25 resamples on either side (Efron and
/// Tibshirani 1993).
const RESAMPLES: usize = 1000;
/// The seed of the resamples: the same values always have the same interval.
const SEED: u64 = 1979;
/// The share of the resamples below the interval, and above it: 95 % are in between.
const TAIL: f64 = 0.025;

/// An interval that holds 95 % of the resampled figures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Interval {
    /// Whether the value is in the interval.
    pub fn has(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    fn of(mut figures: Vec<f64>) -> Interval {
        figures.sort_by(f64::total_cmp);
        Interval { low: quantile(&figures, TAIL), high: quantile(&figures, 1.0 - TAIL) }
    }
}

/// The interval of the median of a sample; both ends are not numbers for no values.
pub fn median_interval(values: &[f64]) -> Interval {
    let mut random = Random::new(SEED);
    Interval::of((0..RESAMPLES).map(|_| median(&resampled(values, &mut random))).collect())
}

/// The interval of `median(a) / median(b)` of two samples that are not paired.
pub fn ratio_interval(a: &[f64], b: &[f64]) -> Interval {
    let mut random = Random::new(SEED);
    let mut ratio = |_| median(&resampled(a, &mut random)) / median(&resampled(b, &mut random));
    Interval::of((0..RESAMPLES).map(&mut ratio).collect())
}

/// Draws as many values as there are, each from all of them.
fn resampled(values: &[f64], random: &mut Random) -> Vec<f64> {
    // The product may round up to the number of values.
    let draw = |_| values[((random.unit() * values.len() as f64) as usize).min(values.len() - 1)];
    (0..values.len()).map(draw).collect()
}
