//! Laws that are not linear in their parameters: Levenberg's damped Gauss–Newton steps within bounds, from several
//! starts.
//!
//! The method works on normal equations that are summed shape by shape, because there may be more shapes than memory.
//! The known crates for least squares store all residuals.
//!
//! Theory: page *Sampled fits* of the book.

use super::cell::{SampledCell, Sums};
use super::shapes::{Numbers, Part};
use crate::error::{Error, ErrorKind, Result};
use crate::fit::constrained::solve_nonnegative;
use crate::fit::normal::Normal;

/// The largest number of steps from one start.
const STEPS: usize = 200;
/// The iteration has converged when no single unknown can lower the sum of squares by more than this share.
const PROMISE: f64 = 1e-12;
/// The damping beyond which no step is expected to help.
const STIFFEST: f64 = 1e12;
/// Starts whose errors differ by less than this share of the best error have found the same optimum.
const SAME: f64 = 1e-3;
/// Inner parameters without bounds start between these values, evenly in their logarithm; the first start is one.
const STARTS: [f64; 2] = [0.1, 10.0];

/// The best of several starts.
pub struct Search {
    pub unknowns: Vec<f64>,
    /// The sums at these unknowns.
    pub sums: Sums,
    /// Whether the best start converged within the allowed steps.
    pub converged: bool,
    /// The share of the starts that ended at the same error.
    pub agreeing: f64,
}

/// Minimises from `starts` points within `bounds` of each unknown.
pub fn search(cell: &SampledCell, starts: usize, bounds: &[[f64; 2]]) -> Result<Search> {
    let outer = cell.each_parameter(|law, i| law.outer()[i]);
    let mut found: Vec<(Vec<f64>, Sums, bool)> = Vec::new();
    for start in 0..starts.max(1) {
        let first = outer_solved(cell, &outer, start_of(cell, &outer, start, bounds), bounds)?;
        found.push(descend(cell, first, bounds)?);
    }
    // The law may have no value at a start.
    found.retain(|(_, sums, _)| sums.square.is_finite());
    if found.is_empty() {
        let expected = "a law with finite values at the sampled shapes";
        return Err(Error::expected("force", expected, "no start with them").of_kind(ErrorKind::Infeasible));
    }
    let least = found.iter().map(|(_, sums, _)| sums.square).fold(f64::INFINITY, f64::min);
    let limit = (least.sqrt() * (1.0 + SAME)).powi(2) + PROMISE * found[0].1.size;
    let agreeing = found.iter().filter(|(_, sums, _)| sums.square <= limit).count() as f64 / found.len() as f64;
    let best = found.into_iter().min_by(|a, b| a.1.square.total_cmp(&b.1.square));
    let (unknowns, sums, converged) = best.expect("there is at least one start");
    Ok(Search { unknowns, sums, converged, agreeing })
}

/// Inner parameters as the start prescribes, the same for all springs; outer ones are zero, or as near to it as their
/// bounds allow.
fn start_of(cell: &SampledCell, outer: &[bool], start: usize, bounds: &[[f64; 2]]) -> Vec<f64> {
    let places = cell.each_parameter(|_, i| i);
    let numbers = Numbers { index: start, seed: cell.fit.sampling.seed };
    let value = |(i, &[lower, upper]): (usize, &[f64; 2])| {
        if outer[i] {
            return 0f64.clamp(lower, upper);
        }
        let share = if start == 0 { 0.5 } else { numbers.number(places[i]) };
        let value = match lower.is_finite() && upper.is_finite() {
            true => lower + share * (upper - lower),
            false => STARTS[0] * (STARTS[1] / STARTS[0]).powf(share),
        };
        value.clamp(lower, upper)
    };
    bounds.iter().enumerate().map(value).collect()
}

/// The outer parameters of least squares for given inner ones.
fn outer_solved(cell: &SampledCell, outer: &[bool], mut unknowns: Vec<f64>, bounds: &[[f64; 2]]) -> Result<Vec<f64>> {
    let outer: Vec<usize> = (0..unknowns.len()).filter(|&i| outer[i]).collect();
    if outer.is_empty() {
        return Ok(unknowns);
    }
    let sums = cell.sums(Part::Trained, &unknowns)?;
    let normal = sums.normal.restricted(&outer);
    let bounded = outer.iter().any(|&i| bounds[i][0] >= 0.0);
    let (step, _) = if bounded { solve_nonnegative(&normal) } else { normal.solve() };
    for (&i, step) in outer.iter().zip(step) {
        unknowns[i] = (unknowns[i] + step).clamp(bounds[i][0], bounds[i][1]);
    }
    Ok(unknowns)
}

fn descend(cell: &SampledCell, mut unknowns: Vec<f64>, bounds: &[[f64; 2]]) -> Result<(Vec<f64>, Sums, bool)> {
    let mut sums = cell.sums(Part::Trained, &unknowns)?;
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let slopes = (0..unknowns.len()).filter(|&i| !is_pushed(&sums.normal, &unknowns, bounds, i));
        let promise = slopes.map(|i| sums.normal.rhs[i].powi(2) / sums.normal.entry(i, i).max(f64::MIN_POSITIVE));
        if !sums.square.is_finite() {
            return Ok((unknowns, sums, false));
        }
        if promise.fold(0.0, f64::max) <= PROMISE * sums.square.max(PROMISE * sums.size) {
            return Ok((unknowns, sums, true));
        }
        let (step, promise) = damped(&sums.normal, &unknowns, bounds, damping);
        let tried: Vec<f64> =
            unknowns.iter().zip(&step).zip(bounds).map(|((p, d), b)| (p + d).clamp(b[0], b[1])).collect();
        // A law may have no value far from the start.
        let after = cell.sums(Part::Trained, &tried)?;
        let gain = (sums.square - after.square) / promise;
        if gain > 1e-4 {
            (unknowns, sums) = (tried, after);
            damping *= if gain > 0.75 { 0.1 } else { 1.0 };
        } else {
            damping *= 10.0;
            if damping > STIFFEST {
                return Ok((unknowns, sums, false));
            }
        }
    }
    Ok((unknowns, sums, false))
}

/// Whether an unknown is at a bound and would cross it: the right-hand side points downhill.
fn is_pushed(normal: &Normal, unknowns: &[f64], bounds: &[[f64; 2]], i: usize) -> bool {
    let [lower, upper] = bounds[i];
    (unknowns[i] <= lower && normal.rhs[i] < 0.0) || (unknowns[i] >= upper && normal.rhs[i] > 0.0)
}

/// The step `(M + μ diag M) d = b`. Unknowns that would cross a bound go to it, and the others follow. Also the
/// decrease of the sum of squares that the step predicts.
fn damped(normal: &Normal, unknowns: &[f64], bounds: &[[f64; 2]], damping: f64) -> (Vec<f64>, f64) {
    let count = unknowns.len();
    let mut step = vec![0.0; count];
    let mut free: Vec<usize> =
        (0..count).filter(|&i| !is_pushed(normal, unknowns, bounds, i) && normal.entry(i, i) > 0.0).collect();
    loop {
        let mut equations = normal.restricted(&free);
        let fixed =
            |i: usize| (0..count).filter(|j| !free.contains(j)).map(|j| normal.entry(i, j) * step[j]).sum::<f64>();
        for (place, &i) in free.iter().enumerate() {
            equations.gram[place * free.len() + place] *= 1.0 + damping;
            equations.rhs[place] -= fixed(i);
        }
        let (found, _) = equations.solve();
        free.iter().zip(found).for_each(|(&i, d)| step[i] = d);
        let crosses = |i: usize| {
            let end = unknowns[i] + step[i];
            if end < bounds[i][0] { Some(bounds[i][0]) } else { (end > bounds[i][1]).then_some(bounds[i][1]) }
        };
        let crossing: Vec<(usize, f64)> = free.iter().filter_map(|&i| Some((i, crosses(i)?))).collect();
        if crossing.is_empty() {
            break;
        }
        crossing.iter().for_each(|&(i, bound)| step[i] = bound - unknowns[i]);
        free.retain(|i| crossing.iter().all(|(crossed, _)| crossed != i));
    }
    let fall = normal.fall(&step);
    (step, fall)
}
