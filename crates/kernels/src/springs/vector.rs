//! Vectors of any length.

/// `a · b`.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `‖v‖`.
pub fn norm(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

/// `‖b − a‖`.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (b - a) * (b - a)).sum::<f64>().sqrt()
}

/// `v/‖v‖`.
pub fn unit(v: &[f64]) -> Vec<f64> {
    let size = norm(v);
    v.iter().map(|v| v / size).collect()
}
