//! The linear equations of an implicit step: `A = c₂ M + c₁ C + K` on the free degrees of freedom, with the same
//! pattern at every step.

/// How a solution ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Solved {
    pub end: End,
    /// The iterations of conjugate gradients.
    pub iterations: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Exact,
    /// The iterations did not suffice; the best solution so far is returned.
    Rough,
    /// A direction of zero or negative curvature was found.
    Indefinite,
}

/// The matrix and its solver.
pub(super) trait Equations: std::fmt::Debug {
    /// The free degrees of freedom, in the order of the rows.
    fn order(&self) -> &[usize];

    /// `A ← D`, with D a diagonal matrix, given by degree of freedom.
    fn set_diagonal(&mut self, diagonal: &dyn Fn(usize) -> f64);

    /// Adds `factor · values` to the entries, starting at entry number `first`.
    fn add(&mut self, first: usize, factor: f64, values: &[f64]);

    /// Adds this share of the largest diagonal entry to the whole diagonal.
    fn shift(&mut self, share: f64);

    /// Computes what all solutions with this A share, such as a factor; false if A has no factor.
    fn prepare(&mut self) -> bool;

    /// Whether A is positive definite, if that can be proved. `is_prepared` is the result of [`Equations::prepare`].
    /// `x` is a force that is not orthogonal to any direction; it is overwritten.
    fn is_definite(&mut self, is_prepared: bool, x: &mut [f64]) -> Option<bool>;

    /// `x ← A⁻¹ x`, in the order of the rows; `guess` is an approximate solution by degree of freedom.
    fn solve(&mut self, x: &mut [f64], guess: Option<&[f64]>) -> Solved;
}
