//! Natural vibrations of a model.
//!
//! Theory: page *Dynamics* of the book.

use super::inertia::{Inertia, Masses};
use super::linear::{Factor, System};
use crate::error::{Error, ErrorKind, Result};
use crate::springs::dot;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// The number of vectors beyond those that are wanted. The last wanted one converges with the ratio of its eigenvalue
/// to that of the first vector that is left out.
// Symmetric bodies have up to five motions of one frequency (three unless the symmetry is that of an icosahedron), so
// that all copies of the last one have a vector. Twelve modes of a bar of 5 488 hexahedra take 20 s with four, 16 s
// with none and 25 s with eight.
const SPARE: usize = 4;
/// The number of blocks in the basis before it is condensed to its best two. A larger basis converges in fewer rounds
/// and costs the square of its width in memory and products.
const BLOCKS: usize = 6;
/// The largest number of blocks that are computed. Pairs that are not found then are still checked one by one with K.
const ROUNDS: usize = 60;
/// An eigenpair is accepted if `‖A y − θ y‖` is below this share of θ,
// A is symmetric, so that an eigenvalue is as near. Where the rounding of solutions leaves more, all rounds are made, and
// [`TOLERANCE`] decides.
const FOUND: f64 = 1e-11;
/// or below this share of the largest θ, which is the level of rounding.
const ROUNDING: f64 = 1e-14;
/// The largest relative error of ω² that is accepted. On slender bodies rounding alone causes 1e-8, the condition
/// number of K times that of a double.
const TOLERANCE: f64 = 1e-6;

/// The lowest natural vibrations `u(t) = φ cos ωt` of a model: `K φ = ω² M φ` on the free degrees of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// `ω²`, rad²/s², ascending, `[modes]`.
    pub squares: Vec<f64>,
    /// The shapes φ, one per mode, on all degrees of freedom `[points · dimension]`, zero where they are held;
    /// `φᵀ M φ = 1`, kg^(−1/2).
    pub shapes: Vec<Vec<f64>>,
}

impl Modes {
    /// The frequencies `ω/2π`, Hz, `[modes]`.
    pub fn frequencies(&self) -> Vec<f64> {
        self.squares.iter().map(|square| square.sqrt() / TAU).collect()
    }
}

/// The `count` lowest modes of `system`, whose matrix K has the factor `factor`, with masses at the points, `[points]`, kg, or with
/// [`ConsistentMasses`](crate::model::ConsistentMasses). The result is reproducible to the last bit.
///
/// They are the largest eigenvalues `θ = 1/ω²` of `A = D K⁻¹ D W` with `D = diag(M)^½`, `W = D⁻¹ M D⁻¹` and `φ = D⁻¹ y`; A is symmetric in the
/// product `yᵀ W y'`, which is the usual one where masses are lumped. Each mode is verified with K:
/// `√(rᵀ K⁻¹ r/φᵀ K φ)` of its residual `r = K φ − ω² M φ` bounds the relative distance of ω² from an eigenvalue
/// (Weinstein's bound in the energy norm; the Euclidean norm of r is dominated by the rounding of stiff motions).
///
/// # Errors
/// K is not positive definite; there are fewer free degrees of freedom than modes; there are fewer masses than points, or a point that
/// may move has none; the dimension is not 1, 2 or 3; or the uncertainty of an ω² exceeds 1e-6.
pub fn lowest_modes<'a>(
    system: &System,
    factor: &Factor,
    masses: impl Into<Masses<'a>>,
    dimension: usize,
    count: usize,
) -> Result<Modes> {
    modes_of_system(system, factor, masses.into(), dimension, count)
}

/// [`lowest_modes`], without parameters of type: compiled here, where code is optimised, and not with each caller.
fn modes_of_system<'a>(
    system: &System,
    factor: &Factor,
    masses: Masses<'a>,
    dimension: usize,
    count: usize,
) -> Result<Modes> {
    if !factor.is_positive_definite() {
        let error = Error::expected("stiffness", "a positive definite matrix", "motions that meet no resistance");
        return Err(error.of_kind(ErrorKind::Infeasible));
    }
    let solve = |x: &mut [f64]| {
        factor.solve(x);
        Ok(())
    };
    modes_of(system.free(), &|x| system.apply(x), &solve, masses, dimension, count)
}

/// [`lowest_modes`] of a stiffness on the degrees of freedom `free`, positive definite, as its product and what solves with it,
/// several vectors one after the other.
///
/// # Errors
/// As there, and those of `solve`.
pub(super) fn modes_of(
    free: &[usize],
    apply: &dyn Fn(&[f64]) -> Vec<f64>,
    solve: &dyn Fn(&mut [f64]) -> Result<()>,
    masses: Masses,
    dimension: usize,
    count: usize,
) -> Result<Modes> {
    let n = free.len();
    if count > n {
        return Err(Error::expected("modes", format!("at most {n}, the free degrees of freedom"), count));
    }
    let inertia = Inertia::new(masses, free, dimension)?;
    let inverse = |dual: &DMatrix<f64>| {
        let mut x = dual.clone();
        inertia.scale(x.as_mut_slice());
        solve(x.as_mut_slice())?;
        inertia.scale(x.as_mut_slice());
        Ok(x)
    };
    let mut modes = Modes { squares: Vec::with_capacity(count), shapes: Vec::with_capacity(count) };
    for (theta, y) in largest_eigenpairs(&inertia, count, inverse)? {
        let square = 1.0 / theta;
        let mut phi = y;
        inertia.unscale(phi.as_mut_slice());
        let force = DMatrix::from_vec(n, 1, apply(phi.as_slice()));
        let mut momentum = phi.clone();
        inertia.weigh(momentum.as_mut_slice());
        let residual = &force - momentum * square;
        let mut off = residual.clone();
        solve(off.as_mut_slice())?;
        // Rounding may give a small negative product, whose size is still the measure.
        // With `x = K^½ φ` this is `ω² ‖(K^−½ M K^−½ − ω⁻²) x‖/‖x‖`: an eigenvalue is within this share of ω².
        let error = (residual.dot(&off).abs() / phi.dot(&force)).sqrt();
        // NaN is no mode either.
        if !(error <= TOLERANCE) {
            let mode = modes.squares.len() + 1;
            let found = format!("a relative error up to {error:.1e} in mode {mode} of {count}");
            let error = Error::expected("modes", format!("squared frequencies to {TOLERANCE:.0e}"), found);
            return Err(error.of_kind(ErrorKind::Infeasible));
        }
        modes.squares.push(square);
        modes.shapes.push(inertia.spread(phi.as_slice()));
    }
    Ok(modes)
}

/// The `count` largest eigenvalues of `A = B W` on vectors of n entries, in descending order, with eigenvectors of `yᵀ W y = 1`. B and W are
/// symmetric and positive definite: `apply` gives the columns of `B X`, `inertia` those of `W X`.
///
/// The method is block Krylov iteration with Rayleigh–Ritz projection. The residuals of the leading pairs extend the
/// basis, and restarts keep their vectors (Wu, Simon, SIAM J. Matrix Anal. Appl. 22, 2000). The first block is wider
/// than `count`, so that it contains every copy of a repeated eigenvalue; a single vector would contain one copy and
/// find the others only by rounding.
///
/// # Errors
/// The operator gives numbers that are not finite, or an error.
fn largest_eigenpairs(
    inertia: &Inertia,
    count: usize,
    apply: impl Fn(&DMatrix<f64>) -> Result<DMatrix<f64>>,
) -> Result<Vec<(f64, DMatrix<f64>)>> {
    let n = inertia.size();
    // A small body may have fewer free degrees of freedom than the block is to have vectors.
    let width = (count + SPARE).min(n);
    if count == 0 {
        return Ok(Vec::new());
    }
    let none = || DMatrix::zeros(n, 0);
    let (mut basis, mut images, mut projected) = (Basis::new(none(), inertia), none(), DMatrix::zeros(0, 0));
    let mut random = generator();
    let mut block = orthonormal(&basis, DMatrix::from_fn(n, width, |_, _| random()), inertia);
    let mut round = 0;
    loop {
        round += 1;
        let old = basis.vectors.ncols();
        basis = basis.beside(&block);
        let image = apply(block.duals())?;
        images = beside(images, &image);
        let m = basis.vectors.ncols();
        let products = basis.duals().tr_mul(&image);
        projected = projected.resize(m, m, 0.0);
        for (j, column) in (old..m).zip(products.column_iter()) {
            projected.column_mut(j).copy_from(&column);
            // The operator is symmetric in this product: rounding alone would make the row another one.
            projected.row_mut(j).tr_copy_from(&column);
        }
        // Asked first: with an entry that is NaN the decomposition has no meaning.
        if projected.iter().any(|x: &f64| !x.is_finite()) {
            let error = Error::at("stiffness", "its inverse is beyond the range of numbers");
            return Err(error.of_kind(ErrorKind::Infeasible));
        }
        let eigen = springfit_numerics::dense::eigen(projected.clone());
        let mut order: Vec<usize> = (0..m).collect();
        // The decomposition gives eigenvalues in no order.
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let theta = DVector::from_iterator(m, order.iter().map(|&k| eigen.eigenvalues[k]));
        let is_full = m + width > BLOCKS * width;
        // More than those that are wanted, because the next ones slow their convergence down.
        let kept = if is_full { 2 * width } else { width };
        let leading = eigen.eigenvectors.select_columns(&order[..kept]);
        let (vectors, moved) = (&basis.vectors * &leading, &images * &leading);
        let mut residuals: Vec<DVector<f64>> = Vec::new();
        let mut is_found = true;
        for k in 0..width {
            let residual = moved.column(k) - vectors.column(k) * theta[k];
            if norm(&residual, inertia) > (FOUND * theta[k]).max(ROUNDING * theta[0]) {
                // The spare ones serve the others, and need not be found.
                is_found &= k >= count;
                residuals.push(residual);
            }
        }
        if is_full {
            projected = DMatrix::from_diagonal(&theta.rows(0, kept).into_owned());
            (basis, images) = (Basis::new(vectors.clone(), inertia), moved);
        }
        if !is_found && round < ROUNDS {
            block = orthonormal(&basis, DMatrix::from_columns(&residuals), inertia);
        }
        // An empty block: the basis spans all motions that the operator reaches, and its values are exact.
        if is_found || round == ROUNDS || block.vectors.is_empty() {
            return Ok((0..count).map(|k| (theta[k], vectors.columns(k, 1).into_owned())).collect());
        }
    }
}

/// Vectors with `yᵢᵀ W yⱼ = δᵢⱼ`.
struct Basis {
    vectors: DMatrix<f64>,
    /// `W Y`, where W is not the identity.
    duals: Option<DMatrix<f64>>,
}

impl Basis {
    fn new(vectors: DMatrix<f64>, inertia: &Inertia) -> Basis {
        let duals = inertia.metric(vectors.as_slice());
        let duals = duals.map(|duals| DMatrix::from_vec(vectors.nrows(), vectors.ncols(), duals));
        Basis { vectors, duals }
    }

    fn duals(&self) -> &DMatrix<f64> {
        self.duals.as_ref().unwrap_or(&self.vectors)
    }

    fn beside(self, block: &Basis) -> Basis {
        let duals = self.duals.map(|duals| beside(duals, block.duals()));
        Basis { vectors: beside(self.vectors, &block.vectors), duals }
    }
}

/// The columns of both matrices, `[matrix columns]`.
fn beside(matrix: DMatrix<f64>, columns: &DMatrix<f64>) -> DMatrix<f64> {
    let m = matrix.ncols();
    let mut matrix = matrix.resize_horizontally(m + columns.ncols(), 0.0);
    matrix.columns_mut(m, columns.ncols()).copy_from(columns);
    matrix
}

/// `√(yᵀ W y)`.
fn norm(y: &DVector<f64>, inertia: &Inertia) -> f64 {
    inertia.metric(y.as_slice()).map_or_else(|| y.norm(), |dual| dot(y.as_slice(), &dual).max(0.0).sqrt())
}

/// Unit vectors that span what the columns of `block` add to the orthonormal `basis`: the Gram–Schmidt method, applied
/// twice.
fn orthonormal(basis: &Basis, mut block: DMatrix<f64>, inertia: &Inertia) -> Basis {
    for _ in 0..2 {
        // Before the projection, as the measure of what it leaves.
        let sizes: Vec<f64> = block.column_iter().map(|column| norm(&column.into_owned(), inertia)).collect();
        block -= &basis.vectors * basis.duals().tr_mul(&block);
        let mut added: Vec<(DVector<f64>, Option<DVector<f64>>)> = Vec::new();
        for (column, size) in block.column_iter().zip(&sizes) {
            let mut column = column.into_owned();
            for (vector, dual) in &added {
                column.axpy(-dual.as_ref().unwrap_or(vector).dot(&column), vector, 1.0);
            }
            // What remains of a dependent vector is a rounding error.
            let left = norm(&column, inertia);
            // A threshold far above rounding, because the second pass then restores all digits of what is kept.
            if left > 1e-8 * size {
                column /= left;
                let dual = inertia.metric(column.as_slice()).map(DVector::from_vec);
                added.push((column, dual));
            }
        }
        if added.is_empty() {
            return Basis::new(DMatrix::zeros(block.nrows(), 0), inertia);
        }
        block = DMatrix::from_columns(&added.into_iter().map(|(vector, _)| vector).collect::<Vec<_>>());
    }
    Basis::new(block, inertia)
}

/// Numbers between −½ and ½, the same on every machine.
pub(crate) fn generator() -> impl FnMut() -> f64 {
    // Marsaglia's xorshift (2003) from a seed with bits of both kinds; any seed but zero does.
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        // The upper 53 bits are as many as a float holds without rounding.
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}
