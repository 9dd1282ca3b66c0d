//! Least squares under equilibrium with nonnegative constants.

use super::problem::{Optimum, Problem};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use nalgebra::{DMatrix, DVector};

/// The accuracy asked of the conic solver, relative to a right-hand side and columns of norm one.
const TOLERANCE: f64 = 1e-12;
/// How much the optimum over the nonzero constants may exceed that of the conic solver, as a share of `‖b‖²`.
const EXCESS: f64 = 1e-9;
/// A constant below this share of the largest unknown is zero.
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
    if below(&free.unknowns).is_empty() {
        return (clamped(free), true);
    }
    let near = interior_point(problem, bounded);
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
        zero.extend(wrong);
    }
}

/// The optimum to the accuracy of Clarabel's interior-point method, and which of the bounded unknowns are zero there,
/// by the size of their multipliers; None if it reports no solution.
fn interior_point(problem: &Problem, bounded: &[usize]) -> Option<(DVector<f64>, Vec<usize>)> {
    let all: Vec<usize> = (0..problem.a.ncols()).collect();
    let basis = problem.basis(&all);
    let size = problem.b.norm();
    let seen = &problem.a * &basis;
    let n = basis.ncols();
    // min ½ wᵀ P w + qᵀ w over s = B w ≥ 0.
    let p = sparse(&seen.tr_mul(&seen).upper_triangle());
    let q: Vec<f64> = seen.tr_mul(&problem.b).iter().map(|b| -b / size).collect();
    let bounds = sparse(&-basis.select_rows(bounded));
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: TOLERANCE,
        tol_gap_rel: TOLERANCE,
        tol_feas: TOLERANCE,
        ..Default::default()
    };
    let cones = [NonnegativeConeT(bounded.len())];
    let mut solver = DefaultSolver::new(&p, &q, &bounds, &vec![0.0; bounded.len()], &cones, settings).ok()?;
    solver.solve();
    if !matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
        return None;
    }
    let w = size * DVector::from_column_slice(&solver.solution.x[..n]);
    let pairs = solver.solution.z.iter().zip(&solver.solution.s);
    let zero = bounded.iter().zip(pairs).filter(|(_, (z, s))| z > s).map(|(&j, _)| j).collect();
    Some((basis * w, zero))
}

/// The sparse form of the matrix.
fn sparse(matrix: &DMatrix<f64>) -> CscMatrix {
    let (rows, columns) = matrix.shape();
    let entries: Vec<(usize, usize)> =
        (0..columns).flat_map(|j| (0..rows).map(move |i| (i, j))).filter(|&ij| matrix[ij] != 0.0).collect();
    let values = entries.iter().map(|&ij| matrix[ij]).collect();
    let (i, j) = entries.into_iter().unzip();
    CscMatrix::new_from_triplets(rows, columns, i, j, values)
}
