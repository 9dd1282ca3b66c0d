//! Operations on vectors of any length.

pub use crate::scalar::{distance, norm};

/// The scalar product `a · b`.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The unit vector `v/‖v‖`.
pub fn unit(v: &[f64]) -> Vec<f64> {
    let size = norm(v);
    v.iter().map(|v| v / size).collect()
}
