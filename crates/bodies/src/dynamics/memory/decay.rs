//! The exponential rule of one relaxation time over one step.

/// The weights of `q̇ = r − q/τ` over a step of `x = h/τ` in which r changes linearly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decay {
    /// `x`.
    pub steps: f64,
    /// `e = e^(−x)`: what is left of the state.
    pub left: f64,
    /// `γ = (1 − e)/x`: what is left of a change that is spread over the step; 1 for a jump.
    pub mean: f64,
}

/// From here on the closed forms below lose no digits.
const LONG: f64 = 1.0;
/// The number of terms of the series below it: the last is 1e-20.
const TERMS: i32 = 27;

impl Decay {
    /// Over the step h, s, with the relaxation time τ, s.
    pub fn new(step: f64, time: f64) -> Decay {
        let x = step / time;
        // `exp_m1` keeps the digits of `1 − e^(−x)` where x is small.
        let mean = if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x };
        Decay { steps: x, left: (-x).exp(), mean }
    }

    /// `1 − e`.
    pub fn gone(&self) -> f64 {
        -(-self.steps).exp_m1()
    }

    /// `∫ E/τ dt` over the step, J, of a branch whose energy was `before` and is `after`, J, where its power is constant: `Ė = P − E/τ`. It is never
    /// negative.
    pub fn lost(&self, before: f64, after: f64) -> f64 {
        match self.steps > 0.0 {
            // In a short step both terms nearly cancel, and rounding can take their sum below zero.
            true => (after * (1.0 / self.mean - 1.0) + before * (1.0 - self.left / self.mean)).max(0.0),
            false => 0.0,
        }
    }

    /// What a Maxwell element of unit stiffness dissipates over the step, by the squares of its stretch a at the start, of the change c, and by
    /// their product: `∫ s²/τ dt` of `s = a e^(−t/τ) + c (1 − e^(−t/τ))/x`. The form is never negative.
    pub fn dissipation(&self) -> [f64; 3] {
        let x = self.steps;
        if x == 0.0 {
            return [0.0; 3];
        }
        let twice = -(-2.0 * x).exp_m1() / 2.0;
        let of_change = if x < LONG {
            // Σ_(n ≥ 3) (−1)^(n+1) (2^(n−1) − 2) x^(n−2)/n!
            let (mut power, mut sum) = (0.5, 0.0);
            for n in 3..TERMS {
                power *= -x / f64::from(n);
                sum -= power * (2f64.powi(n - 1) - 2.0);
            }
            sum
        } else {
            (x - 2.0 * self.gone() + twice) / (x * x)
        };
        [twice, self.gone() * self.mean, of_change]
    }
}
