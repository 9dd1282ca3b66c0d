//! Linear regression in norms other than the Euclidean one: `min ‖b − A x‖`, with or without `x ≥ 0`, for many
//! equations and few unknowns, in the sum of the absolute residuals, the largest of them, or Huber's function. These are
//! linear and quadratic programmes, which Clarabel's interior-point method solves.
//!
//! The 1-norm and Huber's function are solved in their dual form, with `y` bounded and orthogonal to the columns of
//! `A`. It contains each entry of `A` once, whereas the primal form `± (b − A x) ≤ u` contains it twice and takes three
//! times as long. The maximum norm is determined by few more equations than there are unknowns, so that only some of
//! them are solved, and those that exceed their maximum are added until none does.
//!
//! Theory: page *Sampled fits* of the book.

use nalgebra::{DMatrix, DVector};
use springfit_numerics::convex::{Programme, sparse};

/// The fraction by which an omitted equation may exceed the maximum of those that are used. A smaller one would add
/// equations for what the accuracy of the programmes, 1e-12, leaves open.
const EXCESS: f64 = 1e-9;

/// How much a maximum of zero may be exceeded, relative to the root mean square of the right-hand side: the accuracy of
/// the programmes.
const ROUNDING: f64 = 1e-12;

/// Columns whose pivot is below this fraction of the largest count as combinations of the others. A combination with
/// such a pivot would have coefficients of 1e8, beside which the accuracy of the programmes leaves four digits.
const DEPENDENT: f64 = 1e-8;

/// Columns whose pivots all exceed this fraction of the largest are solved without a change of basis. A change of basis
/// costs a decomposition, and at this condition it would save two digits of twelve.
const INDEPENDENT: f64 = 1e-2;

/// The norm of the residuals that a fit minimises.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Norm {
    /// `Σ r²`.
    Two,
    /// `Σ |r|`.
    One,
    /// `max |r|`.
    Max,
    /// `Σ` of `r²/2` up to `|r| = δ` and of `δ (|r| − δ/2)` beyond (Huber 1964).
    Huber {
        /// `δ` relative to the root mean square of the right-hand side. Zero stands for the limit, the 1-norm.
        share: f64,
    },
}

crate::named!(Norm { "2" => Two, "1" => One, "max" => Max, "huber" => Huber { share: 0.5 } });

/// The `x` that minimises the norm of `rhs − rows x`, with `rows` row-major, `[rhs.len() × unknowns]`; one of them if
/// there are several. `None` if a number is not finite, the share is negative, or the conic solver does not converge.
///
/// `Norm::Two` is included for completeness; normal equations solve it in a fraction of the time.
///
/// # Panics
/// If `rows` has another length.
pub fn solve_norm(rows: &[f64], rhs: &[f64], unknowns: usize, norm: Norm, nonnegative: bool) -> Option<Vec<f64>> {
    assert_eq!(rows.len(), rhs.len() * unknowns, "entries of the matrix");
    let valid = !matches!(norm, Norm::Huber { share } if !(share >= 0.0));
    if !valid || !rows.iter().chain(rhs).all(|value| value.is_finite()) {
        return None;
    }
    let size = root_mean_square(rhs.iter().copied());
    let column = |j: usize| rows.iter().skip(j).step_by(unknowns).copied();
    let scale: Vec<f64> = (0..unknowns).map(|j| root_mean_square(column(j))).collect();
    // Zero is an optimum: nothing is asked for, or nothing has an effect. Neither could be scaled.
    if size == 0.0 || scale.iter().all(|s| *s == 0.0) {
        return Some(vec![0.0; unknowns]);
    }
    let scaled = |row: &[f64]| -> Vec<f64> { row.iter().zip(&scale).map(|(a, s)| ratio(*a, *s)).collect() };
    let rows = rows.chunks_exact(unknowns).flat_map(scaled).collect();
    let residual = Residual { rows, rhs: rhs.iter().map(|b| b / size).collect(), unknowns, nonnegative };
    let mut x = if nonnegative { residual.minimize(norm)? } else { residual.minimize_in_basis(norm)? };
    x.iter_mut().zip(&scale).for_each(|(x, s)| *x = ratio(*x, *s) * size);
    Some(x)
}

/// `a / s`, and zero for an empty column.
fn ratio(a: f64, s: f64) -> f64 {
    if s > 0.0 { a / s } else { 0.0 }
}

fn root_mean_square(values: impl Iterator<Item = f64> + Clone) -> f64 {
    // Squares of numbers beyond 1e154 overflow and those below 1e-154 vanish; relative to the largest they do neither.
    let largest = values.clone().fold(0.0f64, |largest, value| largest.max(value.abs()));
    let count = values.clone().count().max(1) as f64;
    largest * (values.map(|value| ratio(value, largest).powi(2)).sum::<f64>() / count).sqrt()
}

/// The residual `b − A x`, scaled to a unit root mean square of `b` and of the columns of `A`.
struct Residual {
    rows: Vec<f64>,
    rhs: Vec<f64>,
    unknowns: usize,
    nonnegative: bool,
}

impl Residual {
    fn minimize(&self, norm: Norm) -> Option<Vec<f64>> {
        match norm {
            // Huber's function is quadratic up to its bound and linear beyond: without a bound it is the square, with a
            // bound of zero the magnitude.
            Norm::Two => self.smallest_huber(f64::INFINITY),
            Norm::One => self.smallest_huber(0.0),
            Norm::Huber { share } => self.smallest_huber(share),
            Norm::Max => self.smallest_maximum(),
        }
    }

    /// Minimises in a basis of the columns if these are nearly or exactly dependent. The tolerances of the solver are
    /// relative to its largest variable, so that a large `x` would spoil the accuracy. With `x ≥ 0` there is no large
    /// `x`.
    fn minimize_in_basis(&self, norm: Norm) -> Option<Vec<f64>> {
        let a = DMatrix::from_row_slice(self.rhs.len(), self.unknowns, &self.rows);
        let Some(basis) = basis(&a) else { return self.minimize(norm) };
        // nalgebra stores columns, whereas the rows of a residual are one after the other.
        let rows = (a * &basis).transpose().as_slice().to_vec();
        let independent = Residual { rows, rhs: self.rhs.clone(), unknowns: basis.ncols(), nonnegative: false };
        let x = basis * DVector::from_vec(independent.minimize(norm)?);
        Some(x.as_slice().to_vec())
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.rows[i * self.unknowns..][..self.unknowns]
    }

    fn at(&self, i: usize, x: &[f64]) -> f64 {
        self.rhs[i] - self.row(i).iter().zip(x).map(|(a, x)| a * x).sum::<f64>()
    }

    /// `min δ/2 yᵀy − bᵀy` under `−1 ≤ y ≤ 1`, `Aᵀy = 0` (`Aᵀy ≤ 0` for `x ≥ 0`): the dual of Huber's function divided
    /// by `δ` and, for `δ = 0`, of the 1-norm. The multiplier of the equations is `x`.
    fn smallest_huber(&self, share: f64) -> Option<Vec<f64>> {
        let (m, n) = (self.rhs.len(), self.unknowns);
        // No residual of the optimum exceeds the Euclidean norm of b: for a larger δ the problem is least squares.
        let delta = share.min((m as f64).sqrt());
        let quadratic = sparse(m, (0..m).map(|i| [(i, delta)]));
        let linear: Vec<f64> = self.rhs.iter().map(|b| -b).collect();
        let bounds = |i: usize| [(n + i, 1.0), (n + m + i, -1.0)];
        let column = |i: usize| self.row(i).iter().copied().enumerate().chain(bounds(i));
        let constraints = sparse(n + 2 * m, (0..m).map(column));
        let limits = [vec![0.0; n], vec![1.0; 2 * m]].concat();
        // The multiplier of an equation has any sign, that of an inequality none below zero: these are the x.
        let equations = if self.nonnegative { 0 } else { n };
        let optimum = Programme { quadratic, linear, constraints, limits, equations }.optimum()?;
        Some(self.unknowns_of(optimum.multipliers))
    }

    /// Chebyshev's problem by exchange: each round adds the equations with the largest residuals, at most doubling
    /// their number.
    fn smallest_maximum(&self) -> Option<Vec<f64>> {
        let mut taken = vec![false; self.rhs.len()];
        self.sample().into_iter().for_each(|i| taken[i] = true);
        loop {
            let (inside, outside): (Vec<usize>, Vec<usize>) = (0..taken.len()).partition(|&i| taken[i]);
            let x = self.smallest_maximum_of(&inside)?;
            let maximum = inside.iter().fold(0.0f64, |maximum, &i| maximum.max(self.at(i, &x).abs()));
            let allowed = maximum * (1.0 + EXCESS) + ROUNDING;
            let left_out = outside.into_iter().map(|i| (self.at(i, &x).abs(), i));
            let mut worst: Vec<(f64, usize)> = left_out.filter(|(residual, _)| *residual > allowed).collect();
            if worst.is_empty() {
                return Some(x);
            }
            // The worst come first; equal ones stay in their order, so that each run takes the same.
            worst.sort_by(|a, b| b.0.total_cmp(&a.0));
            worst.iter().take(inside.len()).for_each(|&(_, i)| taken[i] = true);
        }
    }

    /// The initial equations: the one with the largest entry of each column, and others spread by the golden ratio,
    /// which does not align with any pattern of the rows.
    fn sample(&self) -> Vec<usize> {
        let (m, n) = (self.rhs.len(), self.unknowns);
        let entry = |i: usize, j: usize| self.row(i)[j].abs();
        let largest = (0..n).filter_map(|j| (0..m).max_by(|&a, &b| entry(a, j).total_cmp(&entry(b, j))));
        let golden = (5f64.sqrt() - 1.0) / 2.0;
        // Chebyshev's optimum is met by n + 1 equations; a few times as many leave little to exchange.
        let spread = (0..4 * n).map(|k| ((k as f64 * golden).fract() * m as f64) as usize);
        largest.chain(spread).collect()
    }

    /// `min t` over `−t ≤ b − A x ≤ t` for the given equations.
    fn smallest_maximum_of(&self, equations: &[usize]) -> Option<Vec<f64>> {
        let (m, n) = (equations.len(), self.unknowns);
        let bounds = if self.nonnegative { n } else { 0 };
        let column = |j: usize| {
            let entry = |&i: &usize| if j < n { self.row(i)[j] } else { -1.0 };
            let opposite = |i: &usize| if j < n { -entry(i) } else { entry(i) };
            let both = equations.iter().map(entry).chain(equations.iter().map(opposite)).enumerate();
            // The bound of an unknown is the row −x ≤ 0; t has none, because the other rows hold it above zero.
            both.chain((j < bounds).then_some((2 * m + j, -1.0))).collect::<Vec<_>>()
        };
        let constraints = sparse(2 * m + bounds, (0..=n).map(column));
        let rhs: Vec<f64> = equations.iter().map(|&i| self.rhs[i]).collect();
        let limits = [rhs.clone(), rhs.iter().map(|b| -b).collect(), vec![0.0; bounds]].concat();
        let linear = [vec![0.0; n], vec![1.0]].concat();
        let quadratic = sparse(n + 1, (0..=n).map(|_| []));
        let optimum = Programme { quadratic, linear, constraints, limits, equations: 0 }.optimum()?;
        Some(self.unknowns_of(optimum.variables))
    }

    /// The unknowns among the variables or multipliers of the solver, with the small remainders at bounds set to zero.
    fn unknowns_of(&self, mut variables: Vec<f64>) -> Vec<f64> {
        variables.truncate(self.unknowns);
        if self.nonnegative {
            variables.iter_mut().for_each(|x| *x = x.max(0.0));
        }
        variables
    }
}

/// A matrix `B` such that the columns of `A B` span those of `A`, are orthogonal and have a unit root mean square;
/// `x = B z` then has the least norm of all with the same residuals. `None` if the columns of `A` can be used directly.
fn basis(a: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (m, n) = a.shape();
    let pivoted = a.clone().qr().unpack_r().col_piv_qr();
    let mut r = pivoted.r();
    let pivots: Vec<f64> = (0..m.min(n)).map(|k| r[(k, k)]).collect();
    // Pivoting puts the largest first, and pivots fall: after the first that is too small there is no other.
    let rank = pivots.iter().take_while(|pivot| **pivot > DEPENDENT * pivots[0]).count();
    if rank == n && pivots[n - 1] > INDEPENDENT * pivots[0] {
        return None;
    }
    pivoted.p().inv_permute_columns(&mut r);
    // A = Q R and Rᵀ = S L, so that A S L⁻ᵀ = Q.
    let (s, l) = r.rows(0, rank).transpose().qr().unpack();
    Some(s * l.transpose().try_inverse()? * (m as f64).sqrt())
}
