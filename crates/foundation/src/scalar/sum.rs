//! Sums of millions of terms.

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

#[cfg(test)]
mod tests {
    use super::Sum;

    /// Ten million tenths, of which a plain sum is off by 1e-4; and a term that is gone when the large ones are.
    #[test]
    fn nothing_is_lost() {
        let sum: Sum = std::iter::repeat_n(0.1, 10_000_000).collect();
        assert!((sum.value() - 1e6).abs() < 1e-9, "{}", sum.value());
        assert_eq!([1.0, 1e100, 1.0, -1e100].into_iter().collect::<Sum>().value(), 2.0);
        assert_eq!([f64::MAX, f64::MAX].into_iter().collect::<Sum>().value(), f64::INFINITY);
    }
}
