//! The divergence under `κ ≥ 0`, solved until its optimality conditions hold: `∂f/∂κ_i = 0` if κ_i > 0, and
//! `∂f/∂κ_i ≥ 0` if κ_i = 0.
//!
//! The barrier method identifies the constants that are nearly zero. From its result a projected Newton method starts
//! (Bertsekas, SIAM J. Control Optim. 20, 221, 1982): constants that are zero and would decrease stay zero, and the
//! others take the Newton step, as far as it decreases the objective. A step is projected onto the bounds instead of
//! ending before them, so that it remains long on flat cells, whose optimal constants differ by orders of magnitude.
//!
//! Theory: page *The divergence* of the book.

use super::dense::{
    FLOOR, add_outers, at_half, at_rounding, factorize, inner, invert, row_products, solve, tie, trace,
};
use super::objective::Balance;
use crate::scalar::Real;
use springfit_numerics::newton::falls_enough;

/// The largest number of Newton steps. After more, rounding stalls the search, and the conditions of optimality decide
/// whether its point counts.
const STEPS: usize = 200;
/// The largest number of halvings of a step; 2⁻⁴⁰ of it changes no more than the last digits.
const HALVINGS: usize = 40;
/// If the squared Newton decrement is below this, rounding hides a further decrease of the objective.
const CLOSE: f64 = 1e-10;
/// The largest slope at the optimum, relative to the terms of which it is a sum. Rounding leaves less unless the
/// Hessian is nearly singular.
const OPTIMAL: f64 = 1e-10;
/// The largest remaining step, relative to the constants. As the steps converge quadratically, the error that this one
/// leaves is at rounding.
const LEFT: f64 = 1e-10;

/// The objective at a point, with its slope and curvature for each unknown.
struct Point<T> {
    value: f64,
    slope: Vec<T>,
    /// The sums of the absolute values of the terms of the slopes.
    terms: Vec<f64>,
    /// The Hessian, `[unknowns × unknowns]`, lower triangle.
    hessian: Vec<T>,
}

/// Improves κ, `[unknowns]`, to the optimum under `κ ≥ 0`, from a point at which `A = Σ κ h hᵀ` is positive definite.
/// `h` has the rows h_s, `[springs × p]`, in units of R̂. False if the optimality conditions are not reached.
pub fn settle<T: Real>(h: &[T], p: usize, unknowns: &[usize], balance: Balance, kappa: &mut [T]) -> bool {
    let at = |kappa: &[T]| Point::at(h, p, unknowns, balance.value(), kappa);
    let count = kappa.len();
    let zero = kappa[0].zero();
    // The constants that only the barrier keeps from zero: a Newton step of their own makes them negative.
    let mut from = kappa.to_vec();
    let Some(start) = at(&from) else { return false };
    for i in 0..count {
        // `κ − slope/curvature < 0` without the division, which a curvature of zero would not survive.
        let fall = start.hessian[i * count + i].clone() * &from[i] - &start.slope[i];
        from[i] = fall.choose(&from[i], &zero);
    }
    let mut point = match at(&from) {
        // All of them at once may be too many: A is then not positive definite, or the objective larger.
        Some(point) if point.value <= start.value => point,
        _ => {
            from = kappa.to_vec();
            start
        }
    };
    for _ in 0..STEPS {
        let free: Vec<usize> =
            // A constant at zero whose slope is not below zero would only leave the bounds: the step is that of the others.
            (0..count).filter(|&i| from[i].exceeds(&zero) || zero.exceeds(&point.slope[i])).collect();
        let Some(step) = point.newton(&free, count) else { return false };
        let decrement: f64 = free.iter().zip(&step).map(|(&i, d)| -(point.slope[i].clone() * d).rounded()).sum();
        let moved = |length: f64| {
            let mut to = from.clone();
            free.iter()
                .zip(&step)
                .for_each(|(&i, d)| to[i] = (from[i].clone() + &d.clone().scaled(&length)).greatest(&zero));
            to
        };
        // The objective has no zero of its own: its rounding is relative to its value, or to one where that is small.
        let size = 1.0 + point.value.abs();
        let whole = moved(1.0);
        let change = from.iter().zip(&whole).map(|(a, b)| (b.clone() - a).rounded().abs()).fold(0.0, f64::max);
        let largest = from.iter().map(|k| k.rounded()).fold(0.0, f64::max);
        if change <= at_rounding::<T>(LEFT) * largest && point.is_optimal(&from) {
            kappa.clone_from_slice(&from);
            return true;
        }
        let mut length = 1.0;
        let next = (0..HALVINGS).find_map(|_| {
            let to = moved(length);
            let falls =
                free.iter().map(|&i| (point.slope[i].clone() * &(to[i].clone() - &from[i])).rounded()).sum::<f64>();
            let is_close = decrement < CLOSE * size && length == 1.0;
            length /= 2.0;
            let next = at(&to)?;
            (is_close || falls_enough(point.value, next.value, falls)).then_some((to, next))
        });
        let Some((to, next)) = next else { break };
        (from, point) = (to, next);
    }
    // The iteration continues as far as rounding allows; the optimality conditions decide.
    let is_optimal = point.is_optimal(&from);
    kappa.clone_from_slice(&from);
    is_optimal
}

impl<T: Real> Point<T> {
    /// None if A is not positive definite.
    fn at(h: &[T], p: usize, unknowns: &[usize], balance: f64, kappa: &[T]) -> Option<Point<T>> {
        let (m, count, zero) = (unknowns.len(), kappa.len(), kappa[0].zero());
        let room = |size: usize| vec![zero.clone(); size];
        let (mut a, mut pivots, mut work, mut inverse) = (room(p * p), room(p), room(p * p), room(p * p));
        add_outers(&mut a, h, p, kappa, unknowns, 1.0);
        let content = trace(&a, p).rounded();
        let least = factorize(&mut a, p, 0.0, &mut pivots);
        // The comparison is negated so that a pivot that is not a number counts as not positive.
        if !(least.rounded() > at_rounding::<T>(FLOOR)) {
            return None;
        }
        let log_determinant: f64 = pivots.iter().map(|pivot| -pivot.rounded().ln()).sum();
        invert(&a, p, &pivots, &mut work, &mut inverse);
        let (mut images, mut once, mut twice) = (room(m * p), room(m * m), room(m * m));
        row_products(h, &inverse, p, false, &mut images);
        row_products(h, &images, p, true, &mut once);
        row_products(&images, &images, p, true, &mut twice);
        let (log, reciprocal) = (zero.constant(&(1.0 - balance)), zero.constant(&(2.0 * balance)));
        let mut hessian = room(count * count);
        tie(&once, &twice, unknowns, count, count, &mut hessian, |a, b| {
            a.clone() * &(log.clone() * a).plus_product(&reciprocal, b)
        });
        let (mut slope, mut terms) = (room(count), vec![0.0; count]);
        for (s, &unknown) in unknowns.iter().enumerate() {
            let row = &h[s * p..(s + 1) * p];
            let (plain, first) = (inner(row, row), log.clone() * &once[s * m + s]);
            let second = twice[s * m + s].clone().scaled(&balance);
            terms[unknown] += plain.rounded() + first.rounded() + second.rounded();
            slope[unknown] = slope[unknown].clone() + &plain - &first - &second;
        }
        let value = content + balance * trace(&inverse, p).rounded() - (1.0 - balance) * log_determinant;
        value.is_finite().then_some(Point { value, slope, terms, hessian })
    }

    /// The Newton step of the free unknowns.
    fn newton(&self, free: &[usize], count: usize) -> Option<Vec<T>> {
        let n = free.len();
        if n == 0 {
            return Some(Vec::new());
        }
        let entry = |(i, j): (usize, usize)| self.hessian[free[i.max(j)] * count + free[i.min(j)]].clone();
        let mut matrix: Vec<T> = (0..n * n).map(|ij| entry((ij / n, ij % n))).collect();
        let mut pivots = vec![self.slope[0].zero(); n];
        // Springs that depend on each other leave directions without curvature,
        // in which the floor keeps the step from being rounding over rounding.
        factorize(&mut matrix, n, at_rounding::<T>(FLOOR), &mut pivots);
        let mut step: Vec<T> = free.iter().map(|&i| self.slope[i].negated()).collect();
        solve(&matrix, n, &pivots, &mut step);
        step.iter().all(|d| d.rounded().is_finite()).then_some(step)
    }

    fn is_optimal(&self, kappa: &[T]) -> bool {
        let allowed = at_half::<T>(OPTIMAL);
        kappa.iter().zip(&self.slope).zip(&self.terms).all(|((k, slope), terms)| {
            let slope = slope.rounded();
            slope >= -allowed * terms && (k.rounded() == 0.0 || slope <= allowed * terms)
        })
    }
}
