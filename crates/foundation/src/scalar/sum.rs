//! Compensated sums, for millions of terms.

use super::DoubleDouble;

/// A compensated sum. For n terms x its error is at most one rounding of the result and `n² u² Σ|x|`, with u = 2⁻⁵³
/// (Neumaier, Z. Angew. Math. Mech. 54, 1974).
#[derive(Debug, Clone, Copy, Default)]
pub struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    /// Adds a term.
    pub fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        // The part of the smaller number that rounding has lost.
        self.lost += if self.sum.abs() >= term.abs() { (self.sum - sum) + term } else { (term - sum) + self.sum };
        self.sum = sum;
    }

    /// The sum with its compensation.
    pub fn kept(&self) -> DoubleDouble {
        let value = self.value();
        // An infinite sum has no compensation.
        let lo = if value.is_finite() { (self.sum - value) + self.lost } else { 0.0 };
        DoubleDouble { hi: value, lo }
    }

    /// The sum, rounded to `f64`.
    pub fn value(&self) -> f64 {
        // After an overflow there is nothing to compensate.
        if self.sum.is_finite() { self.sum + self.lost } else { self.sum }
    }
}

impl FromIterator<f64> for Sum {
    fn from_iter<I: IntoIterator<Item = f64>>(terms: I) -> Sum {
        let mut sum = Sum::default();
        terms.into_iter().for_each(|term| sum.add(term));
        sum
    }
}
