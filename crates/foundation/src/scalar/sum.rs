//! Sums of millions of terms.

use super::DoubleDouble;

/// A sum that keeps what rounding takes from it: of n terms x it errs by one rounding of the result and `n² u² Σ|x|`, u = 2⁻⁵³
/// (Neumaier, Z. Angew. Math. Mech. 54, 1974).
#[derive(Debug, Clone, Copy, Default)]
pub struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    pub fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        // What the smaller of both has lost.
        self.lost += if self.sum.abs() >= term.abs() { (self.sum - sum) + term } else { (term - sum) + self.sum };
        self.sum = sum;
    }

    /// The sum as it is kept.
    pub fn kept(&self) -> DoubleDouble {
        let value = self.value();
        // What is infinite has lost nothing.
        let lo = if value.is_finite() { (self.sum - value) + self.lost } else { 0.0 };
        DoubleDouble { hi: value, lo }
    }

    pub fn value(&self) -> f64 {
        // Beyond the range of numbers nothing can be kept.
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
