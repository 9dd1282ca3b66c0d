//! The tail of the normal distribution.

/// The probability that a number with the standard normal distribution exceeds z.
pub fn beyond(z: f64) -> f64 {
    let tail = erfc(z.abs() / std::f64::consts::SQRT_2) / 2.0;
    if z < 0.0 { 1.0 - tail } else { tail }
}

/// `erfc(x)` of x from 0 on: the continued fraction, and the power series for small x.
fn erfc(x: f64) -> f64 {
    let scale = 2.0 / std::f64::consts::PI.sqrt();
    // The series needs few terms there, and cancels from there on; the continued fraction converges fast beyond.
    if x < 2.0 {
        let (mut term, mut sum) = (x, x);
        // At x = 2 the terms are below 1e-16 of the sum after some 30 of them.
        for n in 1..80 {
            term *= -x * x / f64::from(n);
            sum += term / f64::from(2 * n + 1);
        }
        // Rounding may take the tail a little below zero, which no probability is.
        return (1.0 - scale * sum).max(0.0);
    }
    let fraction = (1..60).rev().fold(x, |below, n| x + f64::from(n) / 2.0 / below);
    scale / 2.0 * (-x * x).exp() / fraction
}
