//! The last digits of the spectral optimum: Newton's method on the eigenvalues at ±t.
//!
//! Rounding limits a barrier method to half of the digits. Once it has identified which eigenvalues of E are at t and
//! which at −t, with eigenvectors `Q₊` and `Q₋`, these conditions are equations: `Q₊ᵀ E(κ) Q₊ = tI` and
//! `Q₋ᵀ E(κ) Q₋ = −tI`. Minimising t under them, with the eigenvalues expanded to second order, gives steps that
//! converge quadratically (Overton and Womersley, SIAM J. Matrix Anal. Appl. 16, 697, 1995). The multipliers U and V
//! are the dual pair `X = Q₊ U Q₊ᵀ`, `Y = Q₋ V Q₋ᵀ` that proves the bound.
//!
//! Theory: page *The 2-norm* of the book.

use super::EXACT;
use super::problem::{Optimum, Problem, Spectrum};
use nalgebra::{Cholesky, DMatrix, DVector};

/// The largest number of Newton steps; one is enough after the barrier method if no other eigenvalue is near.
// From the largest first step, steps that converge quadratically are 0.1, 1e-2, 1e-4 and 1e-8.
const STEPS: usize = 8;
/// A first step above this, relative to t, does not start near the optimum.
const LARGEST: f64 = 0.1;
/// A step below this leaves an error of the order of its square, which is negligible if the gap confirms it.
const CONVERGED: f64 = 1e-6;
/// The gap below which it does, relative to t: the square of [`CONVERGED`].
const CLOSED: f64 = 1e-12;
/// Steps that end below this are as accurate as rounding allows.
const SETTLED: f64 = 1e-10;
/// Eigenvalues of the equations below this count as zero: on degenerate shapes motions are linearly dependent. The
/// equations are in units of t, so that their other eigenvalues are of the size of one.
const SINGULAR: f64 = 1e-9;
/// Factors of the width within which an eigenvalue counts as active: first the one from the barrier method, then those
/// that are tried if the steps do not converge.
const WIDTHS: [f64; 5] = [1.0, 1e1, 1e-1, 1e2, 1e-2];

/// Improves κ, value and bound as far as rounding allows, or leaves them unchanged; each is verified independently. An
/// optimum of less than `EXACT` is not refined.
pub fn refine(problem: &Problem, optimum: &mut Optimum) {
    // An optimum of zero has no eigenvalues at ±t apart from rounding; the negation takes what is not a number along.
    if !(optimum.value > EXACT) {
        return;
    }
    let start = optimum.clone();
    let mut tried = Vec::new();
    for width in WIDTHS {
        let mut kappa = start.kappa.clone();
        let Some(active) = Active::at(problem, &mut kappa, start.value, width) else { continue };
        let set = (active.above, active.below, active.free.clone());
        // Another width may find the same set, whose steps would be the same.
        if tried.contains(&set) {
            continue;
        }
        tried.push(set);
        if converge(problem, active, kappa, optimum) {
            return;
        }
    }
}

/// Newton steps from κ; false if they do not converge.
fn converge(problem: &Problem, mut active: Active, mut kappa: Vec<f64>, optimum: &mut Optimum) -> bool {
    let mut last = 2.0 * LARGEST;
    for _ in 0..STEPS {
        let Some((step, t)) = active.step(problem) else { break };
        let size = step.amax();
        // Half of the last step if the steps only oscillate by rounding.
        // Quadratic convergence more than halves each step: one that does not is the noise of rounding, or a wrong set.
        if !(size < 0.5 * last) {
            break;
        }
        last = size;
        for (&unknown, step) in active.free.iter().zip(step.iter()) {
            kappa[unknown] += active.t * step;
        }
        let is_inside = !problem.nonnegative || kappa.iter().all(|k| *k >= 0.0);
        let rounding = problem.rounding(&kappa);
        // Usually the value is the one that the step predicts.
        let foreseen = t * (1.0 + size * size) + rounding;
        let is_near = size < CONVERGED && is_inside && problem.reaches(&kappa, foreseen);
        let value = if is_near { foreseen } else { active.set(problem.spectrum(&kappa)) + rounding };
        // Not by the decrease of the value: at a flat optimum κ can still gain digits when t cannot.
        if is_inside && value <= optimum.value + rounding {
            let bound = problem.bound(&active.x, &active.y);
            // A bound once proved stays proved, whatever later points prove.
            *optimum = Optimum { kappa: kappa.clone(), value, bound: optimum.bound.max(bound) };
            // Value and bound carry a rounding each, and the value that is foreseen has one added.
            if is_near && value - bound < CLOSED * value + 3.0 * rounding {
                return true;
            }
        }
        if is_near {
            active.set(problem.spectrum(&kappa));
        }
    }
    last < SETTLED
}

/// Which eigenvalues are at ±t, and which constants are above zero.
struct Active {
    t: f64,
    /// The spectrum of E.
    spectrum: Spectrum,
    /// The numbers of eigenvalues at t and at −t.
    above: usize,
    below: usize,
    /// The unknowns that are not held at zero.
    free: Vec<usize>,
    /// The dual pair, with `tr X + tr Y = 1`.
    x: DMatrix<f64>,
    y: DMatrix<f64>,
}

impl Active {
    /// The active set that the barrier method implies. With `X = μ (tI − E)⁻¹` and `Y = μ (tI + E)⁻¹` an eigenvalue is
    /// active if its multiplier exceeds its distance from t divided by `width`; a constant is set to zero by the same
    /// rule.
    fn at(problem: &Problem, kappa: &mut [f64], t: f64, width: f64) -> Option<Active> {
        let p = problem.order();
        let empty = || DMatrix::zeros(p, p);
        let spectrum = problem.spectrum.clone();
        let mut active = Active { t, spectrum, above: 0, below: 0, free: Vec::new(), x: empty(), y: empty() };
        let values = &active.spectrum.values;
        // The end is outside by rounding: distances from t would have no sign.
        if !(values.amax() < t) {
            return None;
        }
        // Scaled so that the traces of both add up to one, as those of a dual pair do.
        let mu = 1.0 / values.iter().map(|e| 1.0 / (t - e) + 1.0 / (t + e)).sum::<f64>();
        let near = |distance: f64| distance * distance < width * width * mu * t;
        active.above = values.iter().filter(|e| near(t - **e)).count();
        active.below = values.iter().filter(|e| near(t + **e)).count();
        // Without an active eigenvalue there is no equation, and one cannot be at both ends.
        if active.above + active.below == 0 || active.above + active.below > p {
            return None;
        }
        let (q, shares) = (&active.spectrum.vectors, values.map(|e| mu / (t - e)));
        active.x = combination(&q.columns(0, active.above).into_owned(), &diagonal(&shares, 0, active.above));
        let shares = values.map(|e| mu / (t + e));
        let first = p - active.below;
        active.y = combination(&q.columns(first, active.below).into_owned(), &diagonal(&shares, first, active.below));
        let mean = kappa.iter().map(|k| k.abs()).sum::<f64>() / kappa.len() as f64;
        active.free = (0..kappa.len()).filter(|&i| !problem.nonnegative || !near(kappa[i] * t / mean)).collect();
        if active.free.len() < kappa.len() {
            (0..kappa.len()).filter(|i| !active.free.contains(i)).for_each(|i| kappa[i] = 0.0);
            active.set(problem.spectrum(kappa));
        }
        Some(active)
    }

    /// Stores the eigenvalues and returns t, the largest absolute value.
    fn set(&mut self, spectrum: Spectrum) -> f64 {
        self.spectrum = spectrum;
        self.t = self.spectrum.values.amax();
        self.t
    }

    /// The step of the free unknowns, in units of t, and the t that it predicts; stores the new dual pair.
    ///
    /// The second derivatives depend on the multipliers, which the barrier method gives to about one digit, so that
    /// they are solved for twice.
    fn step(&mut self, problem: &Problem) -> Option<(DVector<f64>, f64)> {
        let (p, f) = (problem.order(), self.free.len());
        let values = &self.spectrum.values / self.t;
        // w_s = Qᵀ h_s
        let w = self.spectrum.vectors.transpose() * &problem.h;
        let side = |sign, first, count, multipliers: &DMatrix<f64>| {
            let q = self.spectrum.vectors.columns(first, count).into_owned();
            let multipliers = q.transpose() * multipliers * &q;
            let others = others(&w, &values, sign, first, count);
            ActiveSide { sign, first, pairs: pairs(count), multipliers, bends: others.tr_mul(&w), others }
        };
        let mut sides = [side(1.0, 0, self.above, &self.x), side(-1.0, p - self.below, self.below, &self.y)];
        let equations = sides[0].pairs.len() + sides[1].pairs.len();
        // As many equations as unknowns: the second derivatives do not matter.
        let turns = if equations > f { 1 } else { 2 };
        let mut solution = DVector::zeros(0);
        for _ in 0..turns {
            let (system, rhs) = self.system(problem, &w, &values, &sides);
            solution = solve(system, &rhs)?;
            let mut row = f + 1;
            for side in &mut sides {
                for &(a, b) in &side.pairs {
                    // The equations weight entries beside the diagonal by √2, so that the norm of a pair is that of its matrix.
                    side.multipliers[(a, b)] += solution[row] / weight(a, b);
                    side.multipliers[(b, a)] = side.multipliers[(a, b)];
                    row += 1;
                }
                make_positive(&mut side.multipliers);
            }
        }
        let mut steps = DVector::zeros(problem.unknown_count());
        self.free.iter().zip(solution.iter()).for_each(|(&unknown, step)| steps[unknown] = *step);
        [self.x, self.y] = sides.map(|side| {
            // The eigenvectors rotate with the step, to first order.
            let count = side.multipliers.nrows();
            let mut changes = w.rows(side.first, count).transpose();
            for (mut row, &unknown) in changes.row_iter_mut().zip(problem.unknowns) {
                row *= -side.sign * steps[unknown];
            }
            let mut turned = side.others * changes;
            (0..count).for_each(|i| turned[(side.first + i, i)] = 1.0);
            combination(&(&self.spectrum.vectors * turned), &side.multipliers)
        });
        Some((solution.rows(0, f).into_owned(), self.t * solution[f]))
    }

    /// The equations of a step, with the unknowns: free constants, t, and the changes of the multipliers.
    fn system(
        &self,
        problem: &Problem,
        w: &DMatrix<f64>,
        values: &DVector<f64>,
        sides: &[ActiveSide; 2],
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (m, f) = (problem.h.ncols(), self.free.len());
        let mut place = vec![None; problem.unknown_count()];
        self.free.iter().enumerate().for_each(|(i, unknown)| place[*unknown] = Some(i));
        let springs: Vec<(usize, usize)> = (0..m).filter_map(|s| Some((s, place[problem.unknowns[s]]?))).collect();
        let size = f + 1 + sides.iter().map(|side| side.pairs.len()).sum::<usize>();
        let (mut system, mut rhs) = (DMatrix::zeros(size, size), DVector::zeros(size));
        rhs[f] = -1.0;
        let mut row = f + 1;
        for ActiveSide { sign, first, pairs, multipliers, bends, .. } in sides {
            // A side without an active pair has no constraint.
            if pairs.is_empty() {
                continue;
            }
            let at = w.rows(*first, multipliers.nrows());
            let weights = at.transpose() * multipliers * at;
            for &(o, j) in &springs {
                for &(s, i) in &springs {
                    system[(i, j)] += 2.0 * weights[(s, o)] * bends[(s, o)];
                }
            }
            for &(a, b) in pairs {
                let multiplier = weight(a, b) * multipliers[(a, b)];
                for &(s, i) in &springs {
                    let entry = -sign * weight(a, b) * at[(a, s)] * at[(b, s)];
                    system[(row, i)] += entry;
                    system[(i, row)] += entry;
                    rhs[i] -= entry * multiplier;
                }
                if a == b {
                    system[(row, f)] = -1.0;
                    system[(f, row)] = -1.0;
                    rhs[row] = -sign * values[first + a];
                    rhs[f] += multiplier;
                }
                row += 1;
            }
        }
        (system, rhs)
    }
}

/// The eigenvalues at t, or those at −t.
struct ActiveSide {
    sign: f64,
    /// The index of the first of them among all.
    first: usize,
    /// The upper triangle of the multipliers.
    pairs: Vec<(usize, usize)>,
    multipliers: DMatrix<f64>,
    /// `D w_s` over the other eigenvectors, with D the reciprocal distances of their eigenvalues.
    others: DMatrix<f64>,
    /// `w_sᵀ D w_t`: the curvature of the eigenvalues at ±t.
    bends: DMatrix<f64>,
}

fn others(w: &DMatrix<f64>, values: &DVector<f64>, sign: f64, first: usize, count: usize) -> DMatrix<f64> {
    let mut others = w.clone();
    for (i, mut row) in others.row_iter_mut().enumerate() {
        let is_active = i >= first && i < first + count;
        row *= if is_active { 0.0 } else { 1.0 / (1.0 - sign * values[i]) };
    }
    others
}

fn pairs(order: usize) -> Vec<(usize, usize)> {
    (0..order).flat_map(|b| (0..=b).map(move |a| (a, b))).collect()
}

/// The weight with which the entries of the upper triangle have the norm of the matrix.
fn weight(a: usize, b: usize) -> f64 {
    if a == b { 1.0 } else { std::f64::consts::SQRT_2 }
}

fn diagonal(values: &DVector<f64>, first: usize, count: usize) -> DMatrix<f64> {
    DMatrix::from_diagonal(&values.rows(first, count).into_owned())
}

/// `Q U Qᵀ`.
fn combination(q: &DMatrix<f64>, u: &DMatrix<f64>) -> DMatrix<f64> {
    q * u * q.transpose()
}

/// Removes the negative part of a symmetric matrix.
fn make_positive(a: &mut DMatrix<f64>) {
    // A factor is cheap and mostly exists, so that eigenvalues are computed only where it does not.
    if a.is_empty() || Cholesky::new(a.clone()).is_some() {
        return;
    }
    // Without its negative eigenvalues the matrix is the nearest one that is positive (Higham, Linear Algebra Appl.
    // 103, 1988).
    let eigen = springfit_numerics::dense::eigen(a.clone());
    *a = combination(&eigen.eigenvectors, &DMatrix::from_diagonal(&eigen.eigenvalues.map(|e| e.max(0.0))));
}

/// The solution, of least norm if there are several; None if a distance of eigenvalues was zero.
fn solve(system: DMatrix<f64>, rhs: &DVector<f64>) -> Option<DVector<f64>> {
    // An eigenvalue beside the active ones at ±t has an infinite reciprocal distance.
    if !system.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    // Eigenvalues, which tell what is singular, take several times as long: they are for the few systems that need
    // them.
    let factors = system.clone().lu();
    if factors.lu_internal().diagonal().amin() > SINGULAR {
        return factors.solve(rhs);
    }
    let eigen = springfit_numerics::dense::eigen(system);
    let mut parts = eigen.eigenvectors.transpose() * rhs;
    for (part, value) in parts.iter_mut().zip(eigen.eigenvalues.iter()) {
        *part = if value.abs() > SINGULAR { *part / value } else { 0.0 };
    }
    let solution = eigen.eigenvectors * parts;
    solution.iter().all(|entry| entry.is_finite()).then_some(solution)
}
