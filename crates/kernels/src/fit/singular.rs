//! `min ½ kᵀ M k − bᵀ k` under `k ≥ 0` where `M` is singular and has a unit diagonal: of all optima the one of least norm.
//!
//! The gradient `M k − b` is the same for all optima (Mangasarian 1988, Operations Research Letters 7). With S the constants
//! whose slope is zero, the optima are the `k ≥ 0` with `M_SS k_S = b_S` and zeros elsewhere, `k_S = p + P λ`: p is the solution of
//! least norm and P the projection onto the null space of `M_SS`. The one of least norm is that of
//! `min ½ λᵀ P λ + pᵀ λ` under `λ ≥ 0`, whose gradient is `k_S`: a problem of the same form.
//!
//! Theory: page *Least squares* of the book.

use super::constrained::slope_tolerance;
use super::normal::{Normal, least_singular};
use nalgebra::{DMatrix, DVector};

/// The optimum of least norm, in the scaling of the equations; `None` if rounding leaves no point that satisfies the
/// conditions of optimality.
pub fn least_nonnegative(normal: &Normal) -> Option<Vec<f64>> {
    let tolerance = slope_tolerance(normal.largest());
    let any = vertex(normal, tolerance)?;
    let slopes = normal.gradient(&any);
    let flat: Vec<usize> = (0..any.len()).filter(|&s| slopes[s] <= tolerance || any[s] > 0.0).collect();
    let least = least_among(&normal.restricted(&flat)).map(|k| spread(&flat, &k, any.len()));
    [least, Some(any)].into_iter().flatten().find(|k| excess(normal, k) <= tolerance)
}

/// The largest violation of the conditions `M k − b ≥ 0` and `k (M k − b) = 0` by constants that are not negative.
pub fn excess(normal: &Normal, k: &[f64]) -> f64 {
    let violation = |(k, slope): (&f64, f64)| if *k > 0.0 { slope.abs() } else { -slope };
    k.iter().zip(normal.gradient(k)).map(violation).fold(0.0, f64::max)
}

/// The `k ≥ 0` of least norm with `M k = b`.
fn least_among(normal: &Normal) -> Option<Vec<f64>> {
    let free = normal.least_norm();
    if free.iter().all(|k| *k >= 0.0) {
        return Some(free);
    }
    let m = normal.size();
    let eigen = DMatrix::from_fn(m, m, |s, t| normal.entry(s, t)).symmetric_eigen();
    let least = least_singular(&eigen.eigenvalues);
    let vanishing: Vec<usize> = (0..m).filter(|&i| eigen.eigenvalues[i] <= least).collect();
    let basis = eigen.eigenvectors.select_columns(&vanishing);
    let projection = &basis * basis.transpose();
    let dual = Normal::new(projection.as_slice().to_vec(), free.iter().map(|k| -k).collect());
    let tolerance = slope_tolerance(dual.largest());
    // Constants that the equations determine have no λ; rounding is what is left of their diagonal entry.
    let determined: Vec<usize> = (0..m).filter(|&s| dual.entry(s, s) > tolerance).collect();
    let (scaled, scale) = dual.restricted(&determined).scaled();
    let found: Vec<f64> =
        vertex(&scaled, slope_tolerance(scaled.largest()))?.iter().zip(&scale).map(|(l, s)| l * s).collect();
    let lambda = DVector::from_vec(spread(&determined, &found, m));
    let k = DVector::from_vec(free) + projection * lambda;
    // The constants that are positive solve their equations to rounding.
    let positive: Vec<usize> = (0..m).filter(|&s| k[s] > tolerance).collect();
    let polished = normal.restricted(&positive).least_norm();
    let is_positive = polished.iter().all(|k| *k >= 0.0);
    Some(if is_positive { spread(&positive, &polished, m) } else { k.iter().map(|k| k.max(0.0)).collect() })
}

/// An optimum whose positive constants are linearly independent (Lawson and Hanson 1974, chapter 23).
fn vertex(normal: &Normal, tolerance: f64) -> Option<Vec<f64>> {
    let m = normal.size();
    let (mut k, mut set, mut barred) = (vec![0.0; m], Vec::new(), vec![false; m]);
    for _ in 0..100 + 30 * m {
        let slopes = normal.gradient(&k);
        let candidates = (0..m).filter(|s| !barred[*s] && slopes[*s] < -tolerance && !set.contains(s));
        let Some(entering) = candidates.min_by(|s, t| slopes[*s].total_cmp(&slopes[*t])) else { return Some(k) };
        set.push(entering);
        let is_moved = descend(normal, &mut k, &mut set);
        // A constant that depends on the others, or only rounding lets enter, waits until they have moved.
        if is_moved {
            barred.fill(false);
        }
        barred[entering] = !is_moved;
    }
    None
}

/// Moves k to the optimum over the set, from which constants leave that reach zero; false, without the last of the set, if that one cannot
/// become positive.
fn descend(normal: &Normal, k: &mut [f64], set: &mut Vec<usize>) -> bool {
    let entering = set[set.len() - 1];
    loop {
        let mut free = normal.restricted(set);
        if !free.solve_regular() || (k[entering] == 0.0 && !(free.rhs[set.len() - 1] > 0.0)) {
            set.retain(|s| *s != entering);
            k[entering] = 0.0;
            return false;
        }
        let fall = |(&s, z): (&usize, &f64)| (*z <= 0.0).then(|| (k[s] / (k[s] - z), s));
        let first = set.iter().zip(&free.rhs).filter_map(fall).min_by(|a, b| a.0.total_cmp(&b.0));
        let (share, leaving) = first.map_or((1.0, None), |(share, s)| (share, Some(s)));
        set.iter().zip(&free.rhs).for_each(|(&s, z)| k[s] += share * (z - k[s]));
        let Some(leaving) = leaving else {
            set.iter().zip(&free.rhs).for_each(|(&s, z)| k[s] = *z);
            return true;
        };
        k[leaving] = 0.0;
        set.iter().for_each(|&s| k[s] = k[s].max(0.0));
        set.retain(|&s| k[s] > 0.0);
        if !set.contains(&entering) {
            return false;
        }
    }
}

/// Values of some constants among zeros.
fn spread(set: &[usize], values: &[f64], count: usize) -> Vec<f64> {
    let mut all = vec![0.0; count];
    set.iter().zip(values).for_each(|(&s, value)| all[s] = *value);
    all
}
