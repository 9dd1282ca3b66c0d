//! A quadratic programme whose variables are coupled by its equations alone.

/// A callback `(done, total)` for the progress of a search.
pub type SearchProgress<'a> = dyn FnMut(usize, usize) + 'a;

/// ```text
/// min ½ Σ_i w_i z_i² + ½ Σ_m c_m (d_m·z)²   subject to   A z = 0,   d_m·z = 0 where c_m is infinite,   z_i ≥ l_i
/// ```
///
/// The weights w are positive, so that there is at most one solution.
#[derive(Debug, Clone, Default)]
pub(super) struct Quadratic {
    /// w, `[variables]`.
    pub weights: Vec<f64>,
    /// l, `[variables]`; minus infinity for a variable without a bound.
    pub lower: Vec<f64>,
    /// The number of rows of A.
    pub rows: usize,
    /// Where the points are whose balance of forces the rows are, `[points × dimension]`, m.
    pub points: Vec<f64>,
    /// The number of rows of each point.
    pub dimension: usize,
    /// The columns of A: the rows and values of column i are those from `starts[i]` to `starts[i + 1]`.
    pub starts: Vec<usize>,
    pub places: Vec<usize>,
    pub values: Vec<f64>,
    /// The rows d with their weights c.
    pub dense: Vec<(Vec<f64>, f64)>,
}

/// The variables, and the steps to them.
#[derive(Debug, Clone)]
pub(super) struct Minimum {
    pub variables: Vec<f64>,
    pub steps: u32,
}

impl Quadratic {
    /// Begins a programme that balances the forces at some points, `[points × dimension]`, m, with no variables yet.
    pub fn new(points: &[f64], dimension: usize) -> Quadratic {
        let (rows, points) = (points.len(), points.to_vec());
        Quadratic { rows, points, dimension, starts: vec![0], ..Quadratic::default() }
    }

    /// Adds a variable with its column of A.
    pub fn push(&mut self, weight: f64, lower: f64, column: impl IntoIterator<Item = (usize, f64)>) {
        self.weights.push(weight);
        self.lower.push(lower);
        for (row, value) in column {
            self.places.push(row);
            self.values.push(value);
        }
        self.starts.push(self.places.len());
    }

    /// The number of variables.
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// The rows and values of a column of A.
    pub fn column(&self, variable: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[variable]..self.starts[variable + 1];
        self.places[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    /// Divides the rows of A by their norms. Rows of zeros stay as they are: they are met by every z.
    pub fn normalise(&mut self) {
        let mut squares = vec![0.0; self.rows];
        self.places.iter().zip(&self.values).for_each(|(row, value)| squares[*row] += value * value);
        self.values.iter_mut().zip(&self.places).for_each(|(value, row)| {
            // A row whose entries are all zero has no size to be divided by.
            if squares[*row] > 0.0 {
                *value /= squares[*row].sqrt();
            }
        });
    }

    /// `A z`.
    pub fn apply(&self, z: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.rows];
        // Variables at a bound of zero are many; their products are spared.
        for (variable, z) in z.iter().enumerate().filter(|(_, z)| **z != 0.0) {
            self.column(variable).for_each(|(row, value)| sums[row] += value * z);
        }
        sums
    }

    /// `Aᵀ y + Σ_m η_m d_m`.
    pub fn transposed(&self, y: &[f64], eta: &[f64]) -> Vec<f64> {
        let product = |variable| self.column(variable).map(|(row, value)| value * y[row]).sum();
        let mut sums: Vec<f64> = (0..self.len()).map(product).collect();
        for ((row, _), eta) in self.dense.iter().zip(eta) {
            sums.iter_mut().zip(row).for_each(|(sum, d)| *sum += eta * d);
        }
        sums
    }
}
