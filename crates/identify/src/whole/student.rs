//! Student's distribution, for intervals where the noise is estimated from few residuals.

/// Deviations on either side of the mean that hold 95 % of a normal distribution.
const NORMAL: f64 = 1.959_963_985;
/// Degrees of freedom from which on the first term of the difference from the normal distribution is accurate to 3e-6.
// The next term is `(5 z⁵ + 16 z³ + 3 z)/(96 n²)`, which is 2.8e-6 with n = 1000.
const MANY: usize = 1000;

/// Standard deviations on either side that hold 95 % of Student's distribution with this many degrees of freedom, at least one; without a
/// number of them, those of the normal distribution (Abramowitz and Stegun 1964, 26.7.3, 26.7.4 and 26.7.5).
pub fn ninety_five(freedom: Option<usize>) -> f64 {
    let Some(freedom) = freedom else { return NORMAL };
    // The sum below has half as many terms as there are degrees of freedom, of which displacements have millions.
    if freedom >= MANY {
        return NORMAL + (NORMAL.powi(3) + NORMAL) / (4.0 * freedom as f64);
    }
    // One degree of freedom has the largest, 12.7.
    let (mut low, mut high) = (NORMAL, 13.0);
    // Fifty halvings of an interval of eleven end at rounding.
    for _ in 0..50 {
        let middle = (low + high) / 2.0;
        if held(middle, freedom.max(1)) < 0.95 { low = middle } else { high = middle }
    }
    high
}

/// The probability of at most t deviations on either side.
fn held(t: f64, freedom: usize) -> f64 {
    let angle = (t / (freedom as f64).sqrt()).atan();
    let (sine, cosine) = angle.sin_cos();
    let is_odd = freedom % 2 == 1;
    let (mut term, mut sum) = (if is_odd { cosine } else { 1.0 }, 0.0);
    for power in (if is_odd { 1 } else { 0 }..freedom.saturating_sub(1)).step_by(2) {
        sum += term;
        term *= (power + 1) as f64 / (power + 2) as f64 * cosine * cosine;
    }
    if is_odd { (angle + sine * sum) * std::f64::consts::FRAC_2_PI } else { sine * sum }
}
