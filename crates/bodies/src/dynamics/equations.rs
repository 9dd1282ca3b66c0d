//! The equations of an implicit step: `A = c₂ M + c₁ C + K` on the free degrees of freedom, with the same pattern at every step.

/// How a solution ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Solved {
    pub end: End,
    /// Of conjugate gradients.
    pub iterations: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Exact,
    /// The iterations did not suffice; what they found is there.
    Rough,
    /// A direction of no or negative curvature was met.
    Indefinite,
}

/// The matrix and what solves it.
pub(super) trait Equations: std::fmt::Debug {
    /// The free degrees of freedom, in the order of the rows.
    fn order(&self) -> &[usize];

    /// `A ← D`, a diagonal of the degrees of freedom.
    fn set_diagonal(&mut self, diagonal: &dyn Fn(usize) -> f64);

    /// Adds `factor` times the values of the entries from the one numbered `first` on.
    fn add(&mut self, first: usize, factor: f64, values: &[f64]);

    /// Adds this share of the largest entry of the diagonal to all of it.
    fn shift(&mut self, share: f64);

    /// Works out what all solutions with this A share, such as a factor; false if A has no factor.
    fn prepare(&mut self) -> bool;

    /// Whether A is positive definite, where that is proved: `is_prepared` is what [`Equations::prepare`] has said of it. `x`, a force
    /// that nothing is orthogonal to, is lost.
    fn is_definite(&mut self, is_prepared: bool, x: &mut [f64]) -> Option<bool>;

    /// `x ← A⁻¹ x`, in the order of the rows; `guess` gives what may be near it for each degree of freedom.
    fn solve(&mut self, x: &mut [f64], guess: Option<&[f64]>) -> Solved;
}
