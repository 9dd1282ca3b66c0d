//! Normal equations `M k = b` of a least-squares fit: assembly by groups, and solution.
//!
//! Theory: page *Least squares* of the book.

use super::dense::{at_rounding, eliminate_row, solve as substitute, tie};
use crate::scalar::{Real, Scalar, vectorized};
use crate::springs::Springs;
use nalgebra::{DMatrix, DVector};

/// A pivot below this many rounding errors of its diagonal entry counts as zero. Elimination leaves errors of about m
/// roundings. Pivots above this limit are used, and the digits are lost that the condition costs.
pub(super) const RANK: f64 = 1000.0;

/// The tolerance of the optimality conditions under `k ≥ 0`, as a fraction of the largest |b| in the scaling with a
/// unit diagonal. Rounding of M k leaves less, unless the condition of the equations has cost six digits.
pub(super) const OPTIMALITY: f64 = 1e-10;

/// By how much `M k − b` may be below zero in the scaling with equal diagonal entries, where `largest` is the largest |b|.
pub fn slope_tolerance<T: Real>(largest: f64) -> f64 {
    at_rounding::<T>(OPTIMALITY) * largest
}

/// The equations of one element or one per lane.
#[derive(Debug, Clone)]
pub struct Normal<T = f64> {
    /// The matrix `M`, `[springs × springs]`, of which only the lower triangle is read.
    pub gram: Vec<T>,
    /// The right-hand side `b`, `[springs]`.
    pub rhs: Vec<T>,
    /// Memory for the edge vectors `x_j − x_i` of the length springs, `[springs × dimension]`.
    pub(super) edges: Vec<T>,
    /// Memory for their images under the inverse spread of the nodes, `[springs × dimension]`.
    pub(super) images: Vec<T>,
    /// Memory for the nodes in an orthogonal basis of the linear motions, `[nodes × dimension]`.
    pub(super) positions: Vec<T>,
    /// Memory for the inverse squared lengths of the edges, `[springs]`.
    pub(super) inverse_squares: Vec<T>,
    pub(super) pivots: Vec<T>,
}

/// Whether the objective determines the constants.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rank {
    /// It does.
    #[default]
    Full,
    /// The springs are linearly dependent under this objective. Of all optima the one of least norm is returned, in the
    /// scaling in which `M` has a unit diagonal.
    Deficient,
    /// Rounding leaves no constants that satisfy the conditions of optimality: the constants are zero.
    Unsolved,
}

impl<T> Default for Normal<T> {
    fn default() -> Normal<T> {
        Normal::new(Vec::new(), Vec::new())
    }
}

impl<T> Normal<T> {
    /// The equations of this matrix and right-hand side.
    pub fn new(gram: Vec<T>, rhs: Vec<T>) -> Normal<T> {
        Normal { gram, rhs, edges: vec![], images: vec![], positions: vec![], inverse_squares: vec![], pivots: vec![] }
    }

    /// The number of unknowns.
    pub fn size(&self) -> usize {
        self.rhs.len()
    }
}

impl<T: Scalar> Normal<T> {
    /// The equations of one constant per group: `M_IJ = Σ_{s∈I, t∈J} M_st`, `b_I = Σ_{s∈I} b_s`.
    pub fn tied(&self, groups: &[usize], count: usize, tied: &mut Normal<T>) {
        let zero = self.rhs[0].zero();
        tied.gram.resize(count * count, zero.clone());
        tied.rhs.clear();
        tied.rhs.resize(count, zero.clone());
        vectorized!(zero, {
            tie(
                &self.gram,
                &self.gram,
                groups,
                count,
                count,
                &mut tied.gram,
                #[inline(always)]
                |entry, _| entry.clone(),
            );
            for (s, &i) in groups.iter().enumerate() {
                tied.rhs[i] = tied.rhs[i].clone() + &self.rhs[s];
            }
        });
    }

    /// The equations of these springs, or of one constant per group if they are `tied`.
    pub fn by_unknowns(self, springs: &Springs, tied: bool) -> Normal<T> {
        if !tied {
            return self;
        }
        let mut groups = Normal::default();
        self.tied(springs.groups(), springs.names().len(), &mut groups);
        groups
    }

    /// Computes `M = L D Lᵀ`, with L in the strict lower triangle, and `b ← M⁻¹ b`. Returns false if a pivot vanishes
    /// in some lane. The diagonal of M is kept, the lower triangle is not.
    ///
    /// No scaling is needed: each pivot scales as its diagonal entry.
    pub fn solve_regular(&mut self) -> bool {
        self.solve_to(T::given())
    }

    /// Solves the equations as [`Normal::solve_regular`] does, for input data with the relative error `rounding`.
    pub fn solve_to(&mut self, rounding: f64) -> bool {
        // No unknowns: the empty solution is right.
        let Some(any) = self.rhs.first().cloned() else { return true };
        // A size that the compiler knows unrolls the loops of the small systems, where they are most of the work.
        vectorized!(
            any,
            match self.size() {
                // Pairs of nodes of the triangle, of the quadrilateral and tetrahedron, and of the hexahedron.
                3 if T::UNROLLED => self.factorize(3, rounding),
                6 if T::UNROLLED => self.factorize(6, rounding),
                28 if T::UNROLLED => self.factorize(28, rounding),
                m => self.factorize(m, rounding),
            }
        )
    }

    /// `b ← M⁻¹ b` for another right-hand side, after [`Normal::solve_regular`].
    #[inline(always)]
    pub fn substitute(&self, b: &mut [T]) {
        substitute(&self.gram, self.size(), &self.pivots, b);
    }

    #[inline(always)]
    fn factorize(&mut self, m: usize, rounding: f64) -> bool {
        self.pivots.resize(m, self.rhs[0].zero());
        let (gram, rhs, inverse) = (&mut self.gram[..m * m], &mut self.rhs[..m], &mut self.pivots[..m]);
        let least = T::exact(RANK * rounding);
        for s in 0..m {
            let (before, row) = gram.split_at_mut(s * m);
            let row = &mut row[..=s];
            let pivot = eliminate_row(row, before, inverse, m, s);
            // A relative limit, because springs on lengths, areas and volumes have pivots of different units.
            if !pivot.exceeds(&row[s].clone().scaled(&least)) {
                return false;
            }
            inverse[s] = pivot.one() / &pivot;
        }
        substitute(gram, m, inverse, rhs);
        true
    }
}

impl<T: Clone> Normal<T> {
    /// The equations of the springs `set` alone.
    pub fn restricted(&self, set: &[usize]) -> Normal<T> {
        let m = self.size();
        // The lower triangle alone is filled.
        let entries = set.iter().flat_map(|&s| set.iter().map(move |&t| self.gram[s.max(t) * m + s.min(t)].clone()));
        Normal::new(entries.collect(), set.iter().map(|&s| self.rhs[s].clone()).collect())
    }
}

impl<T: Real> Normal<T> {
    /// The largest |b|.
    pub fn largest(&self) -> f64 {
        self.rhs.iter().fold(0.0, |largest, b| largest.max(b.rounded().abs()))
    }

    /// `M_st`.
    pub fn entry(&self, s: usize, t: usize) -> T {
        self.gram[s.max(t) * self.size() + s.min(t)].clone()
    }

    /// Returns the equations for `k_s/scale_s`, in which `M` has a unit diagonal, and the scales.
    pub fn scaled(&self) -> (Normal<T>, Vec<T>) {
        let m = self.size();
        let scale: Vec<T> = (0..m).map(|s| self.rhs[s].one() / &self.entry(s, s).sqrt()).collect();
        let gram = (0..m * m).map(|st| self.entry(st / m, st % m) * &scale[st / m] * &scale[st % m]).collect();
        let rhs = self.rhs.iter().zip(&scale).map(|(b, s)| b.clone() * s).collect();
        (Normal::new(gram, rhs), scale)
    }

    /// The gradient `M k − b` of `½ kᵀ M k − bᵀ k`.
    pub fn gradient(&self, k: &[T]) -> Vec<T> {
        let term = |s: usize, sum: T, (t, k): (usize, &T)| sum + &(self.entry(s, t) * k);
        let row = |s: usize| k.iter().enumerate().fold(k[s].zero(), |sum, tk| term(s, sum, tk));
        self.rhs.iter().enumerate().map(|(s, b)| row(s) - b).collect()
    }

    /// The equations, or what has replaced them, in `f64`.
    pub fn rounded(&self) -> Normal {
        let all = |values: &[T]| values.iter().map(Real::rounded).collect();
        Normal::new(all(&self.gram), all(&self.rhs))
    }

    /// After [`Normal::solve_regular`]: the least pivot relative to its diagonal entry. The error of the elimination is
    /// about its inverse times a rounding error.
    pub fn least_pivot(&self) -> f64 {
        let m = self.size();
        // The list of pivots has their inverses, by which rows are multiplied.
        (0..m).map(|s| 1.0 / (self.pivots[s].rounded() * self.gram[s * m + s].rounded())).fold(1.0, f64::min)
    }
}

impl Normal {
    /// `2 bᵀd − dᵀ M d`: the decrease of `‖r − J d‖²` from `‖r‖²`, with `M = JᵀJ` and `b = Jᵀr`.
    pub fn fall(&self, d: &[f64]) -> f64 {
        let along = |v: &[f64]| v.iter().zip(d).map(|(v, d)| v * d).sum::<f64>();
        along(&self.rhs) - along(&self.gradient(d))
    }

    /// The solution in which unknowns without influence are zero, and `solve` finds the others.
    pub fn solve_determined(&self, solve: impl Fn(&Normal) -> (Vec<f64>, Rank)) -> (Vec<f64>, Rank) {
        // A zero on the diagonal of a positive matrix is a row of zeros: the unknown has no influence, and no scale.
        let determined: Vec<usize> = (0..self.size()).filter(|&s| self.entry(s, s) > 0.0).collect();
        if determined.len() == self.size() {
            return solve(self);
        }
        let mut k = vec![0.0; self.size()];
        if !determined.is_empty() {
            let (found, rank) = solve(&self.restricted(&determined));
            determined.iter().zip(found).for_each(|(&s, value)| k[s] = value);
            if rank == Rank::Unsolved {
                return (k, rank);
            }
        }
        (k, Rank::Deficient)
    }

    /// `k = M⁻¹ b`; if M is singular, the solution of least norm in the scaling with a unit diagonal.
    pub fn solve(&self) -> (Vec<f64>, Rank) {
        self.solve_determined(Normal::solve_scalable)
    }

    fn solve_scalable(&self) -> (Vec<f64>, Rank) {
        let mut copy = self.clone();
        if copy.solve_regular() {
            return (copy.rhs, Rank::Full);
        }
        (self.least_norm(), Rank::Deficient)
    }

    /// The optimum of least norm in the scaling with a unit diagonal; eigenvalues below rounding of the largest count
    /// as zero.
    pub fn least_norm(&self) -> Vec<f64> {
        let (scaled, scale) = self.scaled();
        let m = self.size();
        // With a unit diagonal the eigenvalues have no unit, whatever springs measure: they can be compared with each other.
        let eigen = springfit_numerics::dense::eigen(DMatrix::from_vec(m, m, scaled.gram));
        let least = RANK * f64::epsilon() * eigen.eigenvalues.amax();
        let mut coefficients = eigen.eigenvectors.tr_mul(&DVector::from_vec(scaled.rhs));
        for (c, &value) in coefficients.iter_mut().zip(&eigen.eigenvalues) {
            // Directions of rounding get no part of the solution, which makes it the shortest of all that are as good.
            *c = if value > least { *c / value } else { 0.0 };
        }
        let k = &eigen.eigenvectors * coefficients;
        k.iter().zip(&scale).map(|(k, s)| k * s).collect()
    }
}
