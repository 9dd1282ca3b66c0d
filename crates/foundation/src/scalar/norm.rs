//! Euclidean lengths of vectors, without overflow or underflow.

/// If a norm lies within these bounds, no square that contributes to it has overflowed or underflowed.
// Squares are then 1e280 at most. An entry that changes the sum is more than 1e-8 of the norm, whose square of 1e-296
// is still a normal number.
const ORDINARY: std::ops::Range<f64> = 1e-140..1e140;

/// The Euclidean norm `‖v‖`. It is not finite only if an entry is not finite or the norm itself overflows.
pub fn norm(v: &[f64]) -> f64 {
    scaled_norm(v, |v| v.iter().map(|x| x * x).sum())
}

/// The distance `‖b − a‖`, with the range of [`norm`].
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    let size = a.iter().zip(b).map(|(a, b)| (b - a) * (b - a)).sum::<f64>().sqrt();
    // Nearly all distances end here, without a list of differences.
    if ORDINARY.contains(&size) { size } else { norm(&a.iter().zip(b).map(|(a, b)| b - a).collect::<Vec<_>>()) }
}

/// The square root of `squares(v)`, a sum of squares of entries of `v`. If the squares overflow or underflow, `v` is
/// first divided by its largest entry.
pub fn scaled_norm(v: &[f64], squares: impl Fn(&[f64]) -> f64) -> f64 {
    let size = squares(v).sqrt();
    if ORDINARY.contains(&size) {
        return size;
    }
    let largest = v.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
    // Zeros have no share, and shares of an infinite entry would be NaN where the norm is infinite.
    if !(largest > 0.0 && largest.is_finite()) || v.iter().any(|x| x.is_nan()) {
        return size;
    }
    let shares: Vec<f64> = v.iter().map(|x| x / largest).collect();
    largest * squares(&shares).sqrt()
}
