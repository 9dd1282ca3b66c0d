//! Positions and differences of positions in space.

/// A position with zeros for the coordinates that it lacks.
pub(super) fn spatial(x: &[f64]) -> [f64; 3] {
    std::array::from_fn(|k| x.get(k).copied().unwrap_or(0.0))
}

/// `a − b`.
pub(super) fn minus(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// The distance of two points.
pub(super) fn hypot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    // No square, which might overflow.
    a.iter().zip(b).fold(0.0_f64, |sum, (a, b)| sum.hypot(a - b))
}

/// The least and the largest coordinates of points.
pub(super) fn ends(points: impl Iterator<Item = [f64; 3]> + Clone) -> [[f64; 3]; 2] {
    let end = |pick: fn(f64, f64) -> f64, start: f64| -> [f64; 3] {
        std::array::from_fn(|k| points.clone().map(|x| x[k]).fold(start, pick))
    };
    [end(f64::min, f64::INFINITY), end(f64::max, f64::NEG_INFINITY)]
}
