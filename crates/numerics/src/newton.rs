//! What damped Newton methods share: how far an objective must fall along a step, and how a matrix is made positive definite.

/// The share of the slope by which an objective must fall along a step (Armijo, Pacific Journal of Mathematics 16, 1966).
const DESCENT: f64 = 1e-4;

/// Whether an objective falls enough from `before` to `now` along a step with this `slope`: its change to first order, below zero.
pub fn falls_enough(before: f64, now: f64, slope: f64) -> bool {
    now <= before + DESCENT * slope
}

/// What is added to the diagonal, as shares of its largest entry, one after the other until the matrix is positive definite: from 1e-4 to ten,
/// beyond which the step is no longer one of the model.
// Each shift that is tried costs a factorisation: with factors of ten there are six at most.
pub fn shifts() -> impl Iterator<Item = f64> {
    std::iter::successors(Some(1e-4), |shift| Some(10.0 * shift)).take(6)
}
