//! `min ½ kᵀ M k − bᵀ k` under `k ≥ 0` where `M` is singular and has a unit diagonal: of all optima the one of least norm.
//!
//! With `M + δ I` in place of `M` the optimum is unique. As δ → 0 it approaches the optimum of least norm (Tikhonov 1966), from which it is
//! `O(δ)` away. Further steps `min ½ kᵀ M k − bᵀ k + ½ δ |k − k_last|²` take what δ has cost from the slopes (Rockafellar 1976), and leave the
//! motion along which the objective is flat as it is.
//!
//! Theory: page *Least squares* of the book.

use super::normal::{Normal, slope_tolerance};

/// The δ of each step, relative to the diagonal. Rounding of the equations moves k along what is flat by about a rounding error over δ, so that
/// the first step decides it; the last ones reach equations that are nearly singular.
const DELTAS: [f64; 10] = [1e-8, 1e-9, 1e-10, 1e-10, 1e-11, 1e-11, 1e-11, 1e-11, 1e-11, 1e-11];
/// The slopes at which the steps end, as a share of what is tolerated.
// The last steps are near the limit of what rounding lets them gain: two digits are left for what is tolerated.
const ENOUGH: f64 = 1e-2;
/// A slope below this share of the largest |b| is rounding.
// A slope is a difference of sums of up to some hundred products, each rounded by 1.1e-16.
const ROUNDING: f64 = 1e-14;

/// The optimum of least norm, in the scaling of the equations; `None` if rounding leaves no point that satisfies the
/// conditions of optimality.
pub fn least_nonnegative(normal: &Normal) -> Option<Vec<f64>> {
    let tolerance = slope_tolerance::<f64>(normal.largest());
    let free = normal.least_norm();
    // The solution of least norm without bounds is the one with them where it violates none.
    if free.iter().all(|k| *k >= 0.0) && violation(normal, &free) <= tolerance {
        return Some(free);
    }
    let m = normal.size();
    let mut k = vec![0.0; m];
    for delta in DELTAS {
        let mut near = normal.clone();
        (0..m).for_each(|s| near.gram[s * m + s] += delta);
        // The first step, from zero, is Tikhonov's; those after it are proximal.
        near.rhs.iter_mut().zip(&k).for_each(|(b, k)| *b += delta * k);
        k = regular_optimum(&near)?;
        if violation(normal, &k) <= ENOUGH * tolerance {
            break;
        }
    }
    (violation(normal, &k) <= tolerance).then_some(k)
}

/// The largest violation of the conditions `M k − b ≥ 0` and `k (M k − b) = 0` by constants that are not negative.
fn violation(normal: &Normal, k: &[f64]) -> f64 {
    // A constant above zero may have no slope at all; one at zero may only have one that pushes it up.
    let violation = |(k, slope): (&f64, f64)| if *k > 0.0 { slope.abs() } else { -slope };
    k.iter().zip(normal.gradient(k)).map(violation).fold(0.0, f64::max)
}

/// The optimum of regular equations, in as many steps as an active-set method takes (Lawson and Hanson 1974, chapter 23): the objective falls in
/// each, so that no set of positive constants returns.
fn regular_optimum(normal: &Normal) -> Option<Vec<f64>> {
    let (m, tolerance) = (normal.size(), ROUNDING * normal.largest());
    let (mut k, mut set, mut barred) = (vec![0.0; m], Vec::new(), vec![false; m]);
    // In exact numbers no set returns, of which rounding makes no promise: the number of steps is bounded.
    for _ in 0..100 + 30 * m {
        let slopes = normal.gradient(&k);
        let candidates = (0..m).filter(|s| !barred[*s] && slopes[*s] < -tolerance && !set.contains(s));
        let Some(entering) = candidates.min_by(|s, t| slopes[*s].total_cmp(&slopes[*t])) else { return Some(k) };
        set.push(entering);
        let is_moved = descend(normal, &mut k, &mut set);
        // A constant that only rounding lets enter waits until others have moved.
        if is_moved {
            barred.fill(false);
        }
        barred[entering] = !is_moved;
    }
    None
}

/// Moves k to the optimum over the set, from which constants leave that reach zero; false, without the last of the set, if that one does not
/// become positive.
fn descend(normal: &Normal, k: &mut [f64], set: &mut Vec<usize>) -> bool {
    let entering = set[set.len() - 1];
    loop {
        let mut free = normal.restricted(set);
        // An entering constant that does not become positive would return the set before it, without end.
        if !free.solve_regular() || (k[entering] == 0.0 && !(free.rhs[set.len() - 1] > 0.0)) {
            set.retain(|s| *s != entering);
            k[entering] = 0.0;
            return false;
        }
        let fall = |(&s, z): (&usize, &f64)| (*z <= 0.0).then(|| (k[s] / (k[s] - z), s));
        let first = set.iter().zip(&free.rhs).filter_map(fall).min_by(|a, b| a.0.total_cmp(&b.0));
        // No constant falls to zero on the way, and the whole step is made.
        let Some((share, leaving)) = first else {
            set.iter().zip(&free.rhs).for_each(|(&s, z)| k[s] = *z);
            return true;
        };
        // Rounding may leave the constant that limits the step a little below zero.
        set.iter().zip(&free.rhs).for_each(|(&s, z)| k[s] = (k[s] + share * (z - k[s])).max(0.0));
        k[leaving] = 0.0;
        set.retain(|&s| k[s] > 0.0);
        if !set.contains(&entering) {
            return false;
        }
    }
}
