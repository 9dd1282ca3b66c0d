//! Least squares under equilibrium with nonnegative constants.

use super::problem::{Optimum, Problem};
use nalgebra::{DMatrix, DVector};
use springfit_numerics::convex::{Programme, sparse};

/// How much the optimum over the nonzero constants may exceed that of the conic solver, as a share of `‖b‖²`. The conic
/// solver ends at 1e-12, or at 1e-8 where rounding stops it. A larger excess means that a constant was taken to zero
/// that is not.
const EXCESS: f64 = 1e-9;
/// A constant below this share of the largest unknown is zero. Its sign is that of rounding, and would send the search
/// through another set.
const ROUNDING: f64 = 1e-13;

/// `min ‖b − A u‖` under `C u = 0` and `u_j ≥ 0` for j in `bounded`; `free` is the optimum without bounds. The conic
/// solver determines which constants are zero, and the optimum over the others is computed to rounding. False if the
/// conic solver found a smaller value.
pub fn solve_bounded(problem: &Problem, bounded: &[usize], free: Optimum) -> (Optimum, bool) {
    let all: Vec<usize> = (0..problem.a.ncols()).collect();
    let below = |u: &DVector<f64>| -> Vec<usize> {
        let least = -ROUNDING * u.amax();
        bounded.iter().copied().filter(|&j| u[j] < least).collect()
    };
    let clamped = |mut optimum: Optimum| {
        bounded.iter().for_each(|&j| optimum.unknowns[j] = optimum.unknowns[j].max(0.0));
        optimum
    };
    // Most cells keep the bounds by themselves, and the conic solver takes many times as long as the equations.
    if below(&free.unknowns).is_empty() {
        return (clamped(free), true);
    }
    let near = interior_point(problem, bounded);
    // Without a conic solution the signs of the free optimum are the best guess; the result then counts as not reached.
    let mut zero = near.as_ref().map_or_else(|| below(&free.unknowns), |(_, zero)| zero.clone());
    loop {
        let set: Vec<usize> = all.iter().copied().filter(|j| !zero.contains(j)).collect();
        let optimum = problem.solve(&set);
        let wrong = below(&optimum.unknowns);
        if wrong.is_empty() {
            let optimum = clamped(optimum);
            let most = EXCESS * problem.b.norm_squared();
            let reached = near.is_some_and(|(u, _)| problem.square(&optimum.unknowns) <= problem.square(&u) + most);
            return (optimum, reached);
        }
        // The set of zeros only grows: there are no more rounds than unknowns.
        zero.extend(wrong);
    }
}

/// The optimum to the accuracy of the interior-point method, and which of the bounded unknowns are zero there,
/// by the size of their multipliers; None if it reports no solution.
fn interior_point(problem: &Problem, bounded: &[usize]) -> Option<(DVector<f64>, Vec<usize>)> {
    let all: Vec<usize> = (0..problem.a.ncols()).collect();
    let basis = problem.basis(&all);
    let size = problem.b.norm();
    let seen = &problem.a * &basis;
    let n = basis.ncols();
    // min ½ wᵀ P w + qᵀ w over s = B w ≥ 0.
    let dense = |matrix: &DMatrix<f64>| {
        let column = |j: usize| matrix.column(j).iter().copied().enumerate().collect::<Vec<_>>();
        sparse(matrix.nrows(), (0..matrix.ncols()).map(column))
    };
    let optimum = Programme {
        quadratic: dense(&seen.tr_mul(&seen).upper_triangle()),
        // The solver's tolerances are for numbers of the size of one.
        linear: seen.tr_mul(&problem.b).iter().map(|b| -b / size).collect(),
        constraints: dense(&-basis.select_rows(bounded)),
        limits: vec![0.0; bounded.len()],
        equations: 0,
    }
    .optimum()?;
    let w = size * DVector::from_column_slice(&optimum.variables[..n]);
    let pairs = optimum.multipliers.iter().zip(&optimum.slacks);
    // At the optimum one of multiplier and slack is zero: the larger one tells which.
    let zero = bounded.iter().zip(pairs).filter(|(_, (z, s))| z > s).map(|(&j, _)| j).collect();
    Some((basis * w, zero))
}
