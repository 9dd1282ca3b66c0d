//! Operations on vectors of any length.

pub use crate::scalar::{distance, norm};

/// The scalar product `a · b`.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The vector product `a × b`.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

/// The unit vector `v/‖v‖`.
pub fn unit(v: &[f64]) -> Vec<f64> {
    let size = norm(v);
    v.iter().map(|v| v / size).collect()
}
