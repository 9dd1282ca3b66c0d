//! Quantiles of a sample.

use serde::Serialize;

/// The quantile at the share `p` of ascending values, by linear interpolation between order statistics: definition 7 of Hyndman and Fan
/// (1996), The American Statistician 50. It is not a number for no values.
pub fn quantile(sorted: &[f64], p: f64) -> f64 {
    // The length less one would underflow for no values.
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = p * last as f64;
    let below = (place.floor() as usize).min(last);
    // The last value has none after it; its weight is zero there.
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// The median of values in any order.
pub fn median(values: &[f64]) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return f64::NAN };
    let mut values = values.to_vec();
    // A bootstrap takes thousands of medians. To select the middle takes a time in proportion to the number of values, and no order of the others.
    let (_, middle, above) = values.select_nth_unstable_by(last / 2, f64::total_cmp);
    let next = above.iter().copied().min_by(f64::total_cmp).unwrap_or(*middle);
    *middle + 0.5 * (last % 2) as f64 * (next - *middle)
}

/// The quantiles of a sample, with its mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantiles {
    /// The number of values.
    pub count: usize,
    /// The mean.
    pub mean: f64,
    /// The least value.
    pub least: f64,
    /// The lower quartile.
    pub lower: f64,
    /// The median.
    pub median: f64,
    /// The upper quartile.
    pub upper: f64,
    /// The quantile at 95 %.
    pub high: f64,
    /// The largest value.
    pub largest: f64,
}

impl Quantiles {
    /// Computes the quantiles of values in any order.
    pub fn of(values: &[f64]) -> Quantiles {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |p| quantile(&sorted, p);
        Quantiles {
            count: sorted.len(),
            mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
            least: at(0.0),
            lower: at(0.25),
            median: at(0.5),
            upper: at(0.75),
            high: at(0.95),
            largest: at(1.0),
        }
    }
}
