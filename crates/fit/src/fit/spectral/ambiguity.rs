//! Spectral optima that are not unique: the constants with the least Frobenius error among the optima.
//!
//! With u the eigenvectors of `E = R̂ − K(κ)` at ±t, the optima differ from κ by directions d with `K(d) u = 0`. Such a
//! d does not change the active eigenvalues, and it can be followed until another eigenvalue reaches ±t.
//!
//! Theory: page *The 2-norm* of the book.

use super::problem::{Optimum, Problem};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use springfit_numerics::dense::{eigen, singular};

/// Eigenvalues within this fraction of ±t are active; the solver leaves them there to about 1e-9.
const ACTIVE: f64 = 1e-6;
/// Singular values of `d ↦ K(d) u` below this fraction of the largest count as zero. What rounding leaves in the
/// directions is inverse to it, and zeros are known to what the solver leaves of the eigenvalues.
const FREE: f64 = 1e-5;
/// Newton steps for each weight of the barrier that keeps the other eigenvalues inside. A weight that takes more ends
/// where it is; the value is tested before the move counts.
const STEPS: usize = 30;
/// How much the move may add to the value; the gap may be 1e-8.
const KEPT: f64 = 2e-9;
/// The weights of that barrier, one after the other. The last one leaves an error of about its size in the square that
/// is minimised.
const WEIGHTS: [f64; 6] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7];

/// Moves κ, an optimum of value t, to the one with the least `‖E‖_F`, to about 1e-6 of the distance. Returns false,
/// with κ unchanged, if the optimum is unique.
pub fn least_frobenius(problem: &Problem, optimum: &mut Optimum) -> bool {
    let Optimum { kappa, value: t, .. } = optimum;
    let (p, t, springs) = (problem.order(), *t, problem.matrices());
    let e = problem.error(kappa);
    let eigen = eigen(e);
    let (active, rest): (Vec<usize>, Vec<usize>) =
        (0..p).partition(|&i| eigen.eigenvalues[i].abs() > t * (1.0 - ACTIVE));
    // All eigenvalues are active, or none if t is only the rounding of an exact fit.
    if active.is_empty() || rest.is_empty() {
        return false;
    }
    let u = eigen.eigenvectors.select_columns(&active);
    let columns: Vec<DVector<f64>> = springs.iter().map(|a| DVector::from_column_slice((a * &u).as_slice())).collect();
    let Some(singular) = singular(DMatrix::from_columns(&columns)) else { return false };
    let rank = singular.rank(FREE);
    // No direction leaves all active eigenvectors as they are: the optimum is unique.
    if rank == kappa.len() {
        return false;
    }
    let directions: Vec<DVector<f64>> = (rank..kappa.len()).map(|i| singular.v.column(i).into_owned()).collect();
    // On the other eigenvectors alone: E_c(w) = Λ − Σ w_i D_i, with ‖E_c‖_F least under −t < E_c < t.
    let others = eigen.eigenvectors.select_columns(&rest);
    let start = DMatrix::from_diagonal(&DVector::from_fn(rest.len(), |i, _| eigen.eigenvalues[rest[i]]));
    let changes: Vec<DMatrix<f64>> = directions
        .iter()
        .map(|d| {
            let mut change = DMatrix::zeros(p, p);
            springs.iter().zip(d.iter()).for_each(|(a, d)| change += a * *d);
            others.transpose() * change * &others
        })
        .collect();
    let w = inner_optimum(&start, &changes, t);
    let mut step = DVector::zeros(kappa.len());
    directions.iter().zip(w.iter()).for_each(|(direction, w)| step += direction * *w);
    // The directions are accurate to rounding over `FREE`: the move goes as far as the value does not increase.
    for length in [1.0, 0.99, 0.9, 0.5] {
        let moved: Vec<f64> = kappa.iter().zip(step.iter()).map(|(k, d)| k + length * d).collect();
        let value = springfit_numerics::dense::eigenvalues(problem.error(&moved)).amax() + problem.rounding(&moved);
        // The value is computed anew with its rounding: the directions alone prove nothing.
        if value <= t * (1.0 + KEPT) {
            *optimum = Optimum { kappa: moved, value: t.max(value), ..*optimum };
            return true;
        }
    }
    false
}

/// `min ‖Λ − Σ w_i D_i‖²_F` with all eigenvalues inside ±t: Newton's method with a barrier, from w = 0.
fn inner_optimum(start: &DMatrix<f64>, changes: &[DMatrix<f64>], t: f64) -> DVector<f64> {
    let n = changes.len();
    let order = start.nrows();
    let identity = DMatrix::identity(order, order);
    // One column for each change, so that all their products are one product of matrices.
    let flat = |all: &[DMatrix<f64>]| DMatrix::from_fn(order * order, n, |at, i| all[i].as_slice()[at]);
    let products = |flat: &DMatrix<f64>| flat.transpose() * flat;
    let distances = products(&flat(changes)) / (t * t);
    let at = |w: &DVector<f64>| {
        let mut e = start.clone();
        changes.iter().zip(w.iter()).for_each(|(d, w)| e -= d * *w);
        e
    };
    let sides = |e: &DMatrix<f64>| {
        let above = (&identity * t - e).cholesky()?;
        let below = (&identity * t + e).cholesky()?;
        Some((above, below))
    };
    let value = |w: &DVector<f64>, weight: f64| {
        let e = at(w);
        let (above, below) = sides(&e)?;
        let log = above.l().diagonal().map(f64::ln).sum() + below.l().diagonal().map(f64::ln).sum();
        Some(0.5 * e.norm_squared() / (t * t) - 2.0 * weight * log)
    };
    let mut w = DVector::zeros(n);
    for weight in WEIGHTS {
        for _ in 0..STEPS {
            let e = at(&w);
            // Rounding at the border may leave e outside, where the barrier has no value: the last point is kept.
            let Some((above, below)) = sides(&e) else { return w };
            // L⁻¹ D L⁻ᵀ, whose trace is that of A⁻¹ D and whose products are the traces of A⁻¹ D_i A⁻¹ D_j.
            let images = |side: &Cholesky<f64, Dyn>| -> Vec<DMatrix<f64>> {
                let l = side.l();
                let half = |d: &DMatrix<f64>| l.solve_lower_triangular(d).map(|half| half.transpose());
                changes.iter().filter_map(|d| half(&half(d)?)).collect()
            };
            let (a, b) = (images(&above), images(&below));
            // The factor of a side has no zero on its diagonal.
            debug_assert!(a.len() == n && b.len() == n);
            let slope =
                DVector::from_fn(n, |i, _| -e.dot(&changes[i]) / (t * t) - weight * (a[i].trace() - b[i].trace()));
            let curvature = &distances + (products(&flat(&a)) + products(&flat(&b))) * weight;
            let Some(factor) = curvature.cholesky() else { return w };
            let step = -factor.solve(&slope);
            let decrease = -slope.dot(&step);
            let before = value(&w, weight).unwrap_or(f64::INFINITY);
            let mut length = 1.0;
            // Armijo's rule with a tenth of the slope. A step that is shortened further than that is rounding.
            while length > 1e-10
                && !value(&(&w + &step * length), weight).is_some_and(|v| v <= before - 0.1 * length * decrease)
            {
                length *= 0.5;
            }
            if length <= 1e-10 {
                break;
            }
            w += &step * length;
            // The value is of the size of one: a smaller decrease is its rounding.
            if decrease < 1e-14 {
                break;
            }
        }
    }
    w
}
