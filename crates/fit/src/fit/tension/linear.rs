//! Null spaces and least squares by orthogonal transformations with pivoting.

use nalgebra::{DMatrix, DVector};

/// A pivot of a constraint below this fraction of the first counts as zero. On regular shapes rounding leaves pivots of
/// some 1e-13 in the place of zeros.
const BALANCED: f64 = 1e-12;
/// A pivot of equations below this fraction of the first counts as zero. It is the square root of the limit for pivots of normal
/// equations.
const DEPENDENT: f64 = 5e-7;

/// Orthonormal columns that span the `u` with `C u = 0`: the last columns of Q in `Cᵀ P = Q R`, where R has no rows.
pub fn null_space(c: &DMatrix<f64>) -> DMatrix<f64> {
    let (p, n) = c.shape();
    // A matrix without columns has no decomposition.
    if n == 0 {
        return DMatrix::zeros(0, 0);
    }
    // Columns of zeros complete Q.
    let mut transposed = DMatrix::zeros(n, p.max(n));
    transposed.columns_mut(0, p).copy_from(&c.transpose());
    let pivoted = transposed.col_piv_qr();
    let rank = rank(&pivoted.r(), BALANCED);
    pivoted.q().columns(rank, n - rank).into_owned()
}

/// An orthonormal basis of the span of these independent columns.
pub fn orthonormal(columns: DMatrix<f64>) -> DMatrix<f64> {
    if columns.ncols() == 0 { columns } else { columns.qr().q() }
}

/// The `u` of least `‖b − A u‖`, of least norm if there are several; and whether there are.
pub fn least_squares(a: DMatrix<f64>, b: &DVector<f64>) -> (DVector<f64>, bool) {
    let n = a.ncols();
    // Without equations every unknown is free: zero is the one of least norm.
    if n == 0 || a.nrows() == 0 {
        return (DVector::zeros(n), n > 0);
    }
    let mut seen = b.clone();
    let a = match a.nrows() > 2 * n {
        // A = Q R first, where there are many more equations than unknowns: each pivot is searched for among all of them.
        true => {
            let plain = a.qr();
            plain.q_tr_mul(&mut seen);
            seen.resize_vertically_mut(n, 0.0);
            plain.unpack_r()
        }
        false => a,
    };
    // A P = Q R, with R = [R₁ R₂] of full rank.
    let pivoted = a.col_piv_qr();
    let r = pivoted.r();
    let rank = rank(&r, DEPENDENT);
    pivoted.q_tr_mul(&mut seen);
    let seen = seen.rows(0, rank);
    let mut u = DVector::zeros(n);
    let solved = if rank == n {
        r.view((0, 0), (n, n)).solve_upper_triangular(&seen)
    } else {
        // Rᵀ = S L, so that u = S L⁻ᵀ Qᵀ b has the least norm.
        let (s, l) = r.rows(0, rank).transpose().qr().unpack();
        l.tr_solve_upper_triangular(&seen).map(|y| s * y)
    };
    if let Some(solved) = solved {
        u.copy_from(&solved);
    }
    pivoted.p().inv_permute_rows(&mut u);
    (u, rank < n)
}

/// The number of pivots before the first that counts as zero.
// Pivoting orders the pivots by size, so that the first small one ends the rank.
fn rank(r: &DMatrix<f64>, least: f64) -> usize {
    let pivots = || (0..r.nrows().min(r.ncols())).map(|i| r[(i, i)].abs());
    let first = pivots().next().unwrap_or(0.0);
    pivots().take_while(|pivot| *pivot > least * first).count()
}
