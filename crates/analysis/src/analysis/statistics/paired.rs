//! Two methods on the same cases, and several on all of them.

use super::bootstrap::{Interval, median_interval};
use super::normal::beyond;
use super::quantile::median;
use serde::Serialize;

/// Figures of two methods that differ by less than this share are the same one, but for rounding.
const SAME: f64 = 1e-9;
/// Two methods tie if their medians differ by less than this share, whatever the probability.
// Tables tell three or four digits of a median. Methods that are the same in theory differ by what their solvers leave, 1e-8 and
// less, on every case alike, which a test of ranks would take for certain.
const EQUAL: f64 = 1e-6;
/// Pairs of at most this number have an exact probability. With more, the normal distribution is accurate to the digits
/// that are told, and the count of ranks grows with the cube.
const EXACT: usize = 25;
/// A verdict is wrong with at most this probability.
// Intervals of 95 % are printed beside the verdict: both leave out the same probability.
const LEVEL: f64 = 0.05;

/// What is said of two methods whose figures are better the smaller they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The first is better.
    First,
    /// The second is better.
    Second,
    /// The difference is not more than their spread.
    Tie,
    /// So few pairs cannot tell, whatever their differences.
    TooFew,
}

/// Two methods on the same cases.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Paired {
    /// The number of cases.
    pub count: usize,
    /// The first has the smaller figure in this number of cases.
    pub wins: usize,
    /// The second has the smaller figure in this number of cases.
    pub losses: usize,
    /// The median of the ratios of the first to the second.
    pub ratio: f64,
    /// The bootstrap interval of that median.
    pub interval: Interval,
    /// The probability of differences as large as these if neither were better: Wilcoxon's signed-rank test of the logarithms, two-sided.
    pub p: f64,
}

impl Paired {
    /// The comparison of figures above zero, in pairs; `None` without any.
    pub fn of(first: &[f64], second: &[f64]) -> Option<Paired> {
        let pairs = first.iter().zip(second).filter(|(a, b)| **a > 0.0 && **b > 0.0 && a.is_finite() && b.is_finite());
        // Logarithms make a ratio and its inverse differences of one size.
        let logs: Vec<f64> = pairs.map(|(a, b)| (a / b).ln()).collect();
        if logs.is_empty() {
            return None;
        }
        let Interval { low, high } = median_interval(&logs);
        Some(Paired {
            count: logs.len(),
            wins: logs.iter().filter(|log| **log < -SAME).count(),
            losses: logs.iter().filter(|log| **log > SAME).count(),
            ratio: median(&logs).exp(),
            interval: Interval { low: low.exp(), high: high.exp() },
            p: signed_rank(&logs),
        })
    }

    /// The verdict with the probability `adjusted`, which takes account of the `made` comparisons of which this is one: a tie where the
    /// interval has 1 or where chance explains the differences.
    pub fn verdict(&self, adjusted: f64, made: usize) -> Verdict {
        let Interval { low, high } = self.interval;
        if low <= 1.0 + EQUAL && high >= 1.0 - EQUAL {
            return Verdict::Tie;
        }
        // All differences have one sign with this probability.
        // The exponent ends at 1000: the power is 9e-302 there, still a number and below any level, and the cast to 32
        // bits holds.
        if made as f64 * 2.0 * 0.5f64.powi(self.count.min(1000) as i32) > LEVEL {
            return Verdict::TooFew;
        }
        match self.ratio < 1.0 {
            _ if adjusted > LEVEL => Verdict::Tie,
            true => Verdict::First,
            false => Verdict::Second,
        }
    }
}

/// The two-sided probability of Wilcoxon (1945), Biometrics Bulletin 1, that differences from a symmetric distribution around zero have
/// ranks as uneven as these. Differences of zero are left out. It is exact for few differences without ties, otherwise that of the normal
/// approximation with the correction for ties and for continuity; 1 without any difference.
pub fn signed_rank(differences: &[f64]) -> f64 {
    let mut known: Vec<f64> = differences.iter().copied().filter(|d| d.abs() > SAME).collect();
    known.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let n = known.len();
    if n == 0 {
        return 1.0;
    }
    let sizes: Vec<f64> = known.iter().map(|d| d.abs()).collect();
    let (ranks, ties) = ranks(&sizes);
    let positive: f64 = known.iter().zip(&ranks).filter(|(d, _)| **d > 0.0).map(|(_, rank)| rank).sum();
    let all = (n * (n + 1)) as f64 / 2.0;
    let smaller = positive.min(all - positive);
    // With ties the sum of ranks takes halves, which the exact distribution of whole ranks does not have.
    if n <= EXACT && ties == 0.0 {
        return (2.0 * share_below(n, smaller as usize)).min(1.0);
    }
    let variance = (n * (n + 1) * (2 * n + 1)) as f64 / 24.0 - ties / 48.0;
    // Half a rank is the correction for continuity: the sum of ranks takes whole values.
    let z = ((smaller - all / 2.0).abs() - 0.5).max(0.0) / variance.sqrt();
    2.0 * beyond(z)
}

/// The ranks from 1 of ascending values, those of equal ones their mean, and `Σ t³ − t` over groups of t equal ones.
fn ranks(sorted: &[f64]) -> (Vec<f64>, f64) {
    let (mut ranks, mut ties, mut start) = (Vec::new(), 0.0, 0);
    while start < sorted.len() {
        // Values are compared with the first of their group, not with the one before, so that a chain of small
        // differences joins no far ones.
        let is_equal = |x: &&f64| **x - sorted[start] <= SAME * sorted[start];
        let count = sorted[start..].iter().take_while(is_equal).count();
        ranks.extend(std::iter::repeat_n(start as f64 + (count as f64 + 1.0) / 2.0, count));
        ties += (count * count * count - count) as f64;
        start += count;
    }
    (ranks, ties)
}

/// The share of all signs of the ranks 1 to n whose positive ranks have at most this sum.
fn share_below(n: usize, most: usize) -> f64 {
    let total = n * (n + 1) / 2;
    // Of at most 25 ranks there are 2²⁵ choices of signs: doubles count them exactly.
    let mut ways = vec![0.0; total + 1];
    ways[0] = 1.0;
    for rank in 1..=n {
        // From the top down, so that each rank is counted once.
        for sum in (rank..=total).rev() {
            ways[sum] += ways[sum - rank];
        }
    }
    // Each rank has either sign with the same chance, so that `2ⁿ` choices are equally likely.
    ways[..=most.min(total)].iter().sum::<f64>() / 2f64.powi(n as i32)
}

/// Probabilities of comparisons that were made together, each raised so that not even one verdict of all is wrong more often than the
/// level says: Holm (1979), Scandinavian Journal of Statistics 6.
pub fn adjust(probabilities: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..probabilities.len()).collect();
    // Holm's factors fall from the least probability to the largest.
    order.sort_by(|a, b| probabilities[*a].total_cmp(&probabilities[*b]));
    let (mut adjusted, mut least) = (vec![0.0; order.len()], 0.0f64);
    for (done, place) in order.iter().enumerate() {
        // Probabilities must not fall along the order: a comparison is no better than one that is worse by itself.
        least = least.max(probabilities[*place] * (order.len() - done) as f64).min(1.0);
        adjusted[*place] = least;
    }
    adjusted
}

/// The mean rank of each method over the cases, from 1 for the smallest figure; methods without a figure in some case have none.
/// `figures` has a list for each method, with an entry for each case.
pub fn mean_ranks(figures: &[Vec<Option<f64>>]) -> Vec<Option<f64>> {
    let complete: Vec<usize> = (0..figures.len()).filter(|m| figures[*m].iter().all(Option::is_some)).collect();
    let cases = figures.first().map_or(0, Vec::len);
    let mut sums = vec![0.0; figures.len()];
    for case in 0..cases {
        let mut known: Vec<(f64, usize)> =
            complete.iter().filter_map(|&method| Some((figures[method][case]?, method))).collect();
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let values: Vec<f64> = known.iter().map(|(value, _)| *value).collect();
        for (rank, (_, method)) in ranks(&values).0.into_iter().zip(&known) {
            sums[*method] += rank;
        }
    }
    let mean = |method: usize| (cases > 0 && complete.contains(&method)).then(|| sums[method] / cases as f64);
    (0..figures.len()).map(mean).collect()
}
