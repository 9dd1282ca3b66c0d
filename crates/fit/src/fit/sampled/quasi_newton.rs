//! A smooth function of few parameters, with or without `p ≥ 0`, by quasi-Newton steps (BFGS; Nocedal and Wright 2006, chapter 6, with
//! the damping of chapter 18), each of which solves a quadratic programme.
//!
//! Theory: page *Sampled fits* of the book.

use crate::error::Result;
use crate::fit::constrained::solve_nonnegative;
use crate::fit::normal::{Normal, Rank};
use crate::random::unit_at;
use crate::springs::dot;
use springfit_numerics::newton::falls_enough;

/// The largest number of steps. A search that is not there then is reported as one that has not ended.
const STEPS: usize = 500;
/// The largest number of times that a step is halved. After them the step is 1e-12 of itself, which no value shows.
const HALVINGS: i32 = 40;
/// The iteration has converged when a step cannot lower the value by more than this share of its scale.
// The value is quadratic around its minimum: parameters are known to the root of this share, 1e-6, which is below what a fit to
// samples tells.
const PROMISE: f64 = 1e-12;
/// Where no step lowers the value, it has converged if the promise is less than this share of the scale. A sum over
/// many shapes has lost some digits of sixteen; at a kink the promise is larger.
const ROUNDING: f64 = 1e-9;
/// The share of the parameters to either side at which a minimum is proved: values there differ by its square, far above their rounding.
const BESIDE: f64 = 1e-3;
/// The least share of its expected curvature that a step is believed to have. The number is Powell's (Nocedal and
/// Wright 2006, procedure 18.2).
const DAMPED: f64 = 0.2;

/// The quadratic function from whose curvature the search begins, and whether the parameters may be negative.
pub struct Quadratic<'a> {
    /// Its matrix, of which the lower triangle is read.
    pub gram: &'a [f64],
    pub nonnegative: bool,
}

/// The end of a search.
pub struct Found {
    pub unknowns: Vec<f64>,
    pub converged: bool,
}

/// Minimises `value`, which returns the value and its slopes, from `start`. `None` if these are not finite there.
///
/// # Errors
/// Those of `value`.
pub fn minimize(
    mut value: impl FnMut(&[f64]) -> Result<(f64, Vec<f64>)>,
    quadratic: &Quadratic,
    start: Vec<f64>,
    scale: f64,
) -> Result<Option<Found>> {
    let count = start.len();
    let mut curvature: Vec<f64> = (0..count * count)
        .map(|ij| quadratic.gram[(ij / count).max(ij % count) * count + (ij / count).min(ij % count)])
        .collect();
    let (mut at, mut is_scaled) = (start, false);
    let (mut own, mut slopes) = value(&at)?;
    let is_finite = |own: f64, slopes: &[f64]| own.is_finite() && slopes.iter().all(|slope| slope.is_finite());
    // From a start without a value no step can be judged.
    if !is_finite(own, &slopes) {
        return Ok(None);
    }
    for _ in 0..STEPS {
        let Some(step) = step(&curvature, &slopes, &at, quadratic.nonnegative) else {
            return Ok(Some(Found { unknowns: at, converged: false }));
        };
        // `−slope − ½ bend` is what the quadratic model falls by along the whole step.
        let (slope, bend) = (dot(&slopes, &step), dot(&step, &product(&curvature, &step)));
        let promise = -slope - 0.5 * bend;
        // The first promise is that of the quadratic function alone, and says nothing of this one.
        let is_flat = is_scaled && !(promise > PROMISE * scale.max(own.abs()));
        let mut found = None;
        for halvings in 0..if is_flat { 0 } else { HALVINGS } {
            let share = 0.5f64.powi(halvings);
            let tried: Vec<f64> = at.iter().zip(&step).map(|(p, d)| p + share * d).collect();
            let (after, slopes_after) = value(&tried)?;
            if is_finite(after, &slopes_after) && falls_enough(own, after, share * slope) {
                found = Some((tried, after, slopes_after));
                break;
            }
        }
        let Some((after, value_after, slopes_after)) = found else {
            // The rounding of the value hides what is left, or the function has a kink.
            if !is_flat && promise > ROUNDING * scale.max(own.abs()) {
                return Ok(Some(Found { unknowns: at, converged: false }));
            }
            // A slope of zero is that of a maximum or of a saddle as well.
            let Some(lower) = lower_beside(&mut value, &at, own, scale, quadratic.nonnegative)? else {
                return Ok(Some(Found { unknowns: at, converged: true }));
            };
            (at, own, slopes, is_scaled) = (lower.0, lower.1, lower.2, true);
            continue;
        };
        let moved: Vec<f64> = after.iter().zip(&at).map(|(a, b)| a - b).collect();
        let mut change: Vec<f64> = slopes_after.iter().zip(&slopes).map(|(a, b)| a - b).collect();
        (at, own, slopes) = (after, value_after, slopes_after);
        // The first step shows how the function bends beside the quadratic one: their ratio scales all of B, before
        // single entries are updated.
        if !is_scaled {
            // A function that bends down along the first step says nothing of its size: the curvature stays.
            let (met, expected) = (dot(&change, &moved), dot(&moved, &product(&curvature, &moved)));
            if met > 0.0 && expected > 0.0 {
                curvature.iter_mut().for_each(|entry| *entry *= met / expected);
            }
            is_scaled = true;
        }
        update(&mut curvature, &moved, &mut change);
    }
    Ok(Some(Found { unknowns: at, converged: false }))
}

/// Parameters with their value and its slopes.
type Point = (Vec<f64>, f64, Vec<f64>);

/// Parameters beside these that have a lower value, where the slopes promise none: these are then at the top of a concave function or at a saddle.
/// All parameters together are changed to either side, once alike and once at random.
fn lower_beside(
    value: &mut impl FnMut(&[f64]) -> Result<(f64, Vec<f64>)>,
    at: &[f64],
    own: f64,
    scale: f64,
    nonnegative: bool,
) -> Result<Option<Point>> {
    let mean = at.iter().map(|p| p.abs()).sum::<f64>() / at.len().max(1) as f64;
    for seed in [None, Some(1)] {
        for side in [BESIDE, -BESIDE] {
            let sign = |i: usize| seed.map_or(1.0, |seed| 2.0 * unit_at(seed, i as u64, 0) - 1.0);
            // A parameter that is zero would not move by a share of itself.
            let moved = at.iter().enumerate().map(|(i, p)| p + side * sign(i) * p.abs().max(mean));
            let tried: Vec<f64> = moved.map(|p| if nonnegative { p.max(0.0) } else { p }).collect();
            let (after, slopes) = value(&tried)?;
            if after < own - ROUNDING * scale.max(own.abs()) {
                return Ok(Some((tried, after, slopes)));
            }
        }
    }
    Ok(None)
}

/// The step to the minimum of `slopesᵀd + ½ dᵀ B d`, with `at + d ≥ 0` if that is asked for. `None` if there is none.
fn step(curvature: &[f64], slopes: &[f64], at: &[f64], nonnegative: bool) -> Option<Vec<f64>> {
    let known = product(curvature, at).iter().zip(slopes).map(|(image, slope)| image - slope).collect();
    let normal = Normal::new(curvature.to_vec(), known);
    // The step is found as its end, because the bounds are those of the parameters and not of their changes.
    let (end, rank) = if nonnegative { solve_nonnegative(&normal) } else { normal.solve() };
    (rank != Rank::Unsolved).then(|| end.iter().zip(at).map(|(end, at)| end - at).collect())
}

/// The formula of Broyden, Fletcher, Goldfarb and Shanno, with Powell's damping, which keeps B positive.
fn update(curvature: &mut [f64], moved: &[f64], change: &mut [f64]) {
    let count = moved.len();
    let image = product(curvature, moved);
    let (expected, met) = (dot(moved, &image), dot(moved, change));
    // A step without curvature divides by zero below.
    if !(expected > 0.0) {
        return;
    }
    if met < DAMPED * expected {
        let share = (1.0 - DAMPED) * expected / (expected - met);
        change.iter_mut().zip(&image).for_each(|(y, image)| *y = share * *y + (1.0 - share) * image);
    }
    let met = dot(moved, change);
    for i in 0..count {
        for j in 0..count {
            curvature[i * count + j] += change[i] * change[j] / met - image[i] * image[j] / expected;
        }
    }
}

fn product(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    matrix.chunks_exact(x.len()).map(|row| dot(row, x)).collect()
}
