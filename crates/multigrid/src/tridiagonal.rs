//! Eigenvalues of the tridiagonal matrices of Lanczos' method.

/// A symmetric tridiagonal matrix.
#[derive(Debug, Clone, Default)]
pub struct Tridiagonal {
    /// The entries of the diagonal.
    pub diagonal: Vec<f64>,
    /// One entry less.
    pub beside: Vec<f64>,
}

impl Tridiagonal {
    /// How many eigenvalues are below x: the negative pivots of `T − x I` (Sylvester's law of inertia).
    fn below(&self, x: f64) -> usize {
        let (mut pivot, mut count) = (1.0_f64, 0);
        for (i, diagonal) in self.diagonal.iter().enumerate() {
            let coupling = if i == 0 { 0.0 } else { self.beside[i - 1].powi(2) / pivot };
            pivot = diagonal - x - coupling;
            // The next coupling is divided by it. A zero counts as below x: x is an eigenvalue of what is above.
            if pivot == 0.0 {
                pivot = -f64::MIN_POSITIVE;
            }
            count += usize::from(pivot < 0.0);
        }
        count
    }

    /// The least and the largest eigenvalue, by bisection between Gershgorin's bounds; `None` of no rows.
    pub fn extremes(&self) -> Option<[f64; 2]> {
        let n = self.diagonal.len();
        let reach = |i: usize| {
            let beside = |i: Option<usize>| i.and_then(|i| self.beside.get(i)).map_or(0.0, |b| b.abs());
            // The first row has no entry before it and the last none after it.
            beside(i.checked_sub(1)) + beside(Some(i))
        };
        let low = (0..n).map(|i| self.diagonal[i] - reach(i)).reduce(f64::min)?;
        let high = (0..n).map(|i| self.diagonal[i] + reach(i)).reduce(f64::max)?;
        // The eigenvalue of this number, counted from the least.
        let find = |number: usize| {
            let (mut low, mut high) = (low, high);
            // More halvings than an interval has numbers, unless it ends near zero.
            for _ in 0..80 {
                let middle = 0.5 * (low + high);
                if self.below(middle) > number { high = middle } else { low = middle }
            }
            0.5 * (low + high)
        };
        Some([find(0), find(n - 1)])
    }
}
