//! The ends of the spectrum of an operator that is symmetric in the inner product of a body.
//!
//! Theory: page *Precision* of the book.

use super::modes::generator;
use crate::springs::dot;
use nalgebra::DMatrix;

/// A value is found once the residual of its vector is below this share of it, all in the norm of the body: an eigenvalue is as near.
// The Ritz value is usually far nearer: it errs by the square of the residual over the distance to the next eigenvalue,
// which is 4e-6 of the value where the next one is twice as large.
const FOUND: f64 = 2e-3;
/// Steps that are made at least: by then a value a hundredth beyond the next is seen.
// Eight steps at least would save a third of the steps on networks of a small cylinder, and 4 % of those on a bar of 3 500
// unknowns.
const LEAST_STEPS: usize = 32;
/// Steps between two looks at the values.
// A look at each step would save 3 % of the steps.
const LOOK: usize = 4;
/// The vectors in the basis before it is condensed to those of each end. Each step costs products with all of them, and
/// each is two vectors in memory.
// Searches to 1e-8 on that bar take 480 steps with it, 496 with 30 vectors, and 476 with as many as there are steps. To
// the share above they take 32 to 40 steps, and nothing is condensed.
const BASIS: usize = 60;
/// The vectors of each end that are kept then. More than one, because those next to the end slow its convergence down.
// With one vector these searches take 568 steps, with five 496, and with 20 as many as with ten.
const KEPT: usize = 10;

/// An approximate eigenvalue θ of the operator A, and its vector.
pub(super) struct Ritz {
    pub value: f64,
    /// `xᵀ R x = 1`, on the free degrees of freedom.
    pub vector: Vec<f64>,
    /// Whether `‖A x − θ x‖` in the norm of R is a small share of θ.
    pub is_found: bool,
}

/// Vectors q and their images `R q`, orthonormal: `qᵢᵀ R qⱼ = δᵢⱼ`.
type Basis = Vec<(Vec<f64>, Vec<f64>)>;

/// The lower and upper end of the spectrum of an operator A that is symmetric in the inner product `xᵀ R y`, until those that are
/// `wanted` are found, or `steps` are made. `metric` is R; `operator` receives `v` and `R v` and gives `A v`. The search
/// begins with the sum of `starts`, each with the same weight. `None` if no step could be made.
///
/// Lanczos' method with full orthogonalisation, restarted with the Ritz vectors of both ends (Wu, Simon, SIAM J. Matrix Anal. Appl. 22,
/// 2000). The projection P is symmetric; its upper triangle is what the orthogonalisation removes. `A Q = Q P + r e_mᵀ`, hence the
/// residual of the Ritz vector `Q y` is `‖r‖ |y_m|`.
pub(super) fn ends(
    metric: impl Fn(&[f64]) -> Vec<f64>,
    operator: impl Fn(&[f64], &[f64]) -> Vec<f64>,
    starts: &[Vec<f64>],
    wanted: [bool; 2],
    steps: usize,
) -> Option<[Ritz; 2]> {
    let n = starts.first()?.len();
    let mut v = vec![0.0; n];
    for start in starts {
        let size = dot(start, &metric(start)).sqrt();
        if size > 0.0 && size.is_finite() {
            // Starts of the same energy count alike, whatever their units are.
            add(&mut v, 1.0 / size, start);
        }
    }
    let mut rv = metric(&v);
    let mut basis: Basis = Vec::new();
    let mut projected = DMatrix::zeros(BASIS, BASIS);
    for step in 1..=steps {
        // Rounding may leave a square just below zero.
        let size = dot(&v, &rv).max(0.0).sqrt();
        if !(size > 0.0 && size.is_finite()) {
            // Nothing is left to search in; with an empty basis the starts had no energy or were not finite.
            return if basis.is_empty() { None } else { found(&basis, &projected, 0.0) };
        }
        v.iter_mut().for_each(|x| *x /= size);
        rv.iter_mut().for_each(|x| *x /= size);
        let mut next = operator(&v, &rv);
        basis.push((v, rv));
        let last = basis.len() - 1;
        // Twice is enough: after a second pass what is left of the others is rounding (Giraud et al., Numer. Math. 101,
        // 2005).
        for _ in 0..2 {
            for (i, (q, rq)) in basis.iter().enumerate() {
                let along = dot(rq, &next);
                projected[(i, last)] += along;
                add(&mut next, -along, q);
            }
        }
        // R v by the same recurrence would lose digits at each step.
        rv = metric(&next);
        v = next;
        let left = dot(&v, &rv).max(0.0).sqrt();
        // What is left is rounding: the basis spans all that the operator reaches from the start.
        let is_whole = !(left > 1e-13 * projected.column(last).norm()) || basis.len() == n;
        if is_whole || step == steps {
            return found(&basis, &projected, if is_whole { 0.0 } else { left });
        }
        let is_full = basis.len() == BASIS;
        // The values of the projection cost its cube, hence not at each step.
        if is_full || (step >= LEAST_STEPS && step % LOOK == 0) {
            let eigen = eigen(&projected, basis.len())?;
            let is_found = |end: usize| residual(&eigen, end, left) <= FOUND * eigen.0[end].abs();
            if (!wanted[0] || is_found(0)) && (!wanted[1] || is_found(basis.len() - 1)) {
                return found(&basis, &projected, left);
            }
            if is_full {
                basis = condensed(&basis, &mut projected, &eigen);
            }
        }
    }
    None
}

/// Numbers that meet every motion, the same on every machine: as displacements they are rough.
pub(super) fn noise(n: usize) -> Vec<f64> {
    let mut random = generator();
    (0..n).map(|_| random()).collect()
}

/// The values, ascending, and the vectors of the projection on m vectors.
type Eigen = (Vec<f64>, DMatrix<f64>);

/// `None` if an entry is not finite.
fn eigen(projected: &DMatrix<f64>, m: usize) -> Option<Eigen> {
    // The lower triangle was never written.
    let whole = DMatrix::from_fn(m, m, |i, j| projected[(i.min(j), i.max(j))]);
    // With an entry that is NaN the decomposition has no meaning.
    if whole.iter().any(|x: &f64| !x.is_finite()) {
        return None;
    }
    let eigen = springfit_numerics::dense::eigen(whole);
    let mut order: Vec<usize> = (0..m).collect();
    // The decomposition gives eigenvalues in no order.
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    Some((order.iter().map(|&k| eigen.eigenvalues[k]).collect(), eigen.eigenvectors.select_columns(&order)))
}

fn residual((values, vectors): &Eigen, index: usize, left: f64) -> f64 {
    left * vectors[(values.len() - 1, index)].abs()
}

/// Both ends; `left` is `‖r‖`.
fn found(basis: &Basis, projected: &DMatrix<f64>, left: f64) -> Option<[Ritz; 2]> {
    let eigen = eigen(projected, basis.len())?;
    let ritz = |index: usize| Ritz {
        value: eigen.0[index],
        vector: combination(basis, &eigen.1, index).0,
        is_found: residual(&eigen, index, left) <= FOUND * eigen.0[index].abs(),
    };
    Some([ritz(0), ritz(basis.len() - 1)])
}

/// The basis of the Ritz vectors of both ends, on which the projection is diagonal.
fn condensed(basis: &Basis, projected: &mut DMatrix<f64>, eigen: &Eigen) -> Basis {
    let kept: Vec<usize> = (0..KEPT).chain(basis.len() - KEPT..basis.len()).collect();
    projected.fill(0.0);
    // The products of the kept vectors with the next one are found when that one is orthogonalised, like all others.
    kept.iter().enumerate().for_each(|(i, &index)| projected[(i, i)] = eigen.0[index]);
    kept.iter().map(|&index| combination(basis, &eigen.1, index)).collect()
}

fn combination(basis: &Basis, vectors: &DMatrix<f64>, index: usize) -> (Vec<f64>, Vec<f64>) {
    let n = basis[0].0.len();
    let (mut q, mut rq) = (vec![0.0; n], vec![0.0; n]);
    for ((own, image), &weight) in basis.iter().zip(vectors.column(index).iter()) {
        add(&mut q, weight, own);
        add(&mut rq, weight, image);
    }
    (q, rq)
}

/// `y ← y + a x`.
fn add(y: &mut [f64], a: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}
