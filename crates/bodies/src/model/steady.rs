//! Springs that pull at rest and have no rest measure, or none that can be stored: their force is constant, or nearly
//! constant.

use crate::springs::Law;
use std::sync::{Arc, LazyLock};

/// The largest multiple of the present measure that is stored as a rest measure. From a larger one the energy would be
/// so large that rounding hides its changes.
const FARTHEST: f64 = 1e10;

/// A rest length below this share of the length is zero.
// It is the length less a pull over the constant, which are equal where springs have no rest length: rounding of sums over a
// point's cells leaves some 1e-15 of either.
const NO_LENGTH: f64 = 1e-12;

/// Whether a spring with the force `pull` at rest, where it measures c, has no rest measure `c − T/k` that can be
/// stored.
pub fn is_steady(constant: f64, pull: f64, c: f64) -> bool {
    pull != 0.0 && pull.abs() > FARTHEST * (constant * c).abs()
}

/// The law of such springs, with the parameters T, the force at rest, and k. Its energy is zero at rest.
pub fn steady_law() -> Arc<Law> {
    static LAW: LazyLock<Arc<Law>> =
        LazyLock::new(|| Arc::new(Law::parse("T + k*(c - c0)").expect("it is a law with parameters")));
    LAW.clone()
}

/// `ℓ + x`, or zero if the sum is only a rounding error.
pub fn rest_length(length: f64, x: f64) -> f64 {
    let rest = length + x;
    if rest.abs() > NO_LENGTH * length { rest } else { 0.0 }
}
