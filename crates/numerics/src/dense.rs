//! Dense matrices whose size is the caller's, such as the stiffness of a small network.
//!
//! A generic function is compiled, and optimised, with the package that calls it. These are compiled here, so that callers whose own code is
//! not optimised run them at full speed.

use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};

/// The product `A B` of matrices, m × n and n × p.
///
/// ```
/// use nalgebra::dmatrix;
/// assert_eq!(springfit_numerics::dense::product(&dmatrix![1.0, 2.0], &dmatrix![3.0; 4.0]), dmatrix![11.0]);
/// ```
pub fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    a * b
}

/// The matrix `k g gᵀ`, n × n, of n numbers g.
///
/// ```
/// use nalgebra::{dmatrix, dvector};
/// assert_eq!(springfit_numerics::dense::outer(2.0, &dvector![1.0, 3.0]), dmatrix![2.0, 6.0; 6.0, 18.0]);
/// ```
pub fn outer(k: f64, g: &DVector<f64>) -> DMatrix<f64> {
    (g * k) * g.transpose()
}

/// The inverse of a square matrix; `None` if it has none.
///
/// ```
/// use nalgebra::dmatrix;
/// assert_eq!(springfit_numerics::dense::inverse(dmatrix![2.0, 0.0; 0.0, 4.0]), Some(dmatrix![0.5, 0.0; 0.0, 0.25]));
/// assert_eq!(springfit_numerics::dense::inverse(dmatrix![1.0, 1.0; 1.0, 1.0]), None);
/// ```
pub fn inverse(a: DMatrix<f64>) -> Option<DMatrix<f64>> {
    a.try_inverse()
}

/// All ρ with `K x = ρ R x`, ascending, of symmetric matrices, n × n, R positive definite: the eigenvalues of `L⁻¹ K L⁻ᵀ` with `R = L Lᵀ`.
/// `None` if R is not positive definite.
///
/// ```
/// use nalgebra::dmatrix;
/// let ratios = springfit_numerics::dense::ratios(&dmatrix![2.0, 1.0; 1.0, 2.0], dmatrix![4.0, 0.0; 0.0, 4.0]).unwrap();
/// assert!((ratios[0] - 0.25).abs() < 1e-15 && (ratios[1] - 0.75).abs() < 1e-15);
/// ```
pub fn ratios(k: &DMatrix<f64>, r: DMatrix<f64>) -> Option<Vec<f64>> {
    let l = r.cholesky()?.l();
    let half = l.solve_lower_triangular(k)?;
    let whole = l.solve_lower_triangular(&half.transpose())?;
    let mut values = eigenvalues((&whole + whole.transpose()) * 0.5).as_slice().to_vec();
    values.sort_unstable_by(f64::total_cmp);
    Some(values)
}

/// All λ with `A v = λ v`, of a symmetric matrix A, n × n, in no order. It is done in n³ operations.
///
/// ```
/// use nalgebra::dmatrix;
/// let eigenvalues = springfit_numerics::dense::eigenvalues(dmatrix![2.0, 1.0; 1.0, 2.0]);
/// assert!((eigenvalues.min() - 1.0).abs() < 1e-14 && (eigenvalues.max() - 3.0).abs() < 1e-14);
/// ```
pub fn eigenvalues(a: DMatrix<f64>) -> DVector<f64> {
    a.symmetric_eigenvalues()
}

/// λ and v with `A v = λ v`, of a symmetric matrix A, n × n; the vectors are orthonormal columns in the order of the values. It is done in
/// n³ operations.
///
/// ```
/// use nalgebra::dmatrix;
/// let eigen = springfit_numerics::dense::eigen(dmatrix![2.0, 1.0; 1.0, 2.0]);
/// let v = eigen.eigenvectors.column(0);
/// assert!((dmatrix![2.0, 1.0; 1.0, 2.0] * v - eigen.eigenvalues[0] * v).norm() < 1e-14);
/// ```
pub fn eigen(a: DMatrix<f64>) -> SymmetricEigen<f64, Dyn> {
    a.symmetric_eigen()
}

/// `A = U Σ Vᵀ`, m × n, by [`singular`].
pub struct Singular {
    /// The n singular values, the largest first. A zero is a zero up to rounding of the largest.
    pub values: DVector<f64>,
    /// `U Σ = A V`, m × n: the columns are orthogonal, and those of vanishing values are rounding.
    pub scaled: DMatrix<f64>,
    /// V, n × n, of orthonormal columns in the order of the values.
    pub v: DMatrix<f64>,
}

impl Singular {
    /// The number of values above `least` of the largest.
    pub fn rank(&self, least: f64) -> usize {
        self.values.iter().filter(|value| **value > least * self.values[0]).count()
    }

    /// `A⁺ = V Σ⁺ Uᵀ`, n × m; values of at most `least` of the largest count as zero. Those below 1e-15 of it are rounding.
    pub fn pseudo_inverse(&self, least: f64) -> DMatrix<f64> {
        let rank = self.rank(least);
        let mut scaled = self.scaled.columns(0, rank).into_owned();
        for (mut column, value) in scaled.column_iter_mut().zip(&self.values) {
            // The square of a small value may be no number.
            column /= *value;
            column /= *value;
        }
        self.v.columns(0, rank) * scaled.transpose()
    }
}

/// The singular values of a matrix of finite numbers, and the vectors: pairs of columns are turned until all are orthogonal (M. R. Hestenes,
/// *Inversion of matrices by biorthogonalization and related results*, 1958). A sweep over all pairs takes m n² operations, and some ten
/// sweeps are enough. `None` of a matrix with other numbers.
///
/// The decomposition of nalgebra 0.35 is wrong, by as much as a tenth of A, for some matrices in a thousand whose vectors are asked for
/// (its issue 1172); its values without vectors, and those of matrices of fixed size, are right.
///
/// ```
/// use nalgebra::dmatrix;
/// let a = dmatrix![1.0, 1.0, 1.0; 1.0, 1.0, 1.0];
/// let singular = springfit_numerics::dense::singular(a.clone()).unwrap();
/// assert!((singular.values[0] - 6.0_f64.sqrt()).abs() < 1e-15 && singular.values[1] < 1e-15);
/// assert!((&singular.scaled * singular.v.transpose() - a).norm() < 1e-15);
/// ```
pub fn singular(a: DMatrix<f64>) -> Option<Singular> {
    // Squares of very large and very small numbers are no numbers.
    let size = match a.amax() {
        size if !size.is_finite() || a.iter().any(|entry| entry.is_nan()) => return None,
        0.0 => 1.0,
        size => size,
    };
    let n = a.ncols();
    let (mut scaled, mut v) = (a / size, DMatrix::identity(n, n));
    // The square of a column that is rounding of the largest: its direction is of no meaning, and never settles.
    let nothing = (f64::EPSILON * scaled.norm()).powi(2);
    for _ in 0..SWEEPS {
        let mut is_turned = false;
        for (p, q) in (0..n).flat_map(|p| (p + 1..n).map(move |q| (p, q))) {
            let (x, y) = (scaled.column(p), scaled.column(q));
            let (xx, yy, xy) = (x.norm_squared(), y.norm_squared(), x.dot(&y));
            if xy.abs() <= f64::EPSILON * (xx * yy).sqrt() || xx.min(yy) <= nothing {
                continue;
            }
            is_turned = true;
            // The smaller of the two angles that make them orthogonal.
            let cotangent = (yy - xx) / (2.0 * xy);
            let tangent = cotangent.signum() / (cotangent.abs() + cotangent.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            turn(&mut scaled, p, q, cosine, cosine * tangent);
            turn(&mut v, p, q, cosine, cosine * tangent);
        }
        if !is_turned {
            break;
        }
    }
    let values: Vec<f64> = scaled.column_iter().map(|column| column.norm() * size).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    Some(Singular {
        values: DVector::from_fn(n, |i, _| values[order[i]]),
        scaled: scaled.select_columns(&order) * size,
        v: v.select_columns(&order),
    })
}

/// Matrices of 3 to 352 columns took 4 to 13 sweeps; more are for matrices that are not known.
const SWEEPS: usize = 60;

/// The columns p and q become `c p − s q` and `s p + c q`.
fn turn(a: &mut DMatrix<f64>, p: usize, q: usize, c: f64, s: f64) {
    let (mut x, mut y) = a.columns_range_pair_mut(p, q);
    for (x, y) in x.iter_mut().zip(y.iter_mut()) {
        (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
    }
}

/// The x of least norm that minimises ‖A x − b‖, by the singular values of A; those of at most `least` of the largest count as zero. `None` of
/// a matrix with a number that is not finite.
///
/// ```
/// use nalgebra::{dmatrix, dvector};
/// let x = springfit_numerics::dense::least_squares(dmatrix![1.0, 1.0; 1.0, 1.0], &dvector![1.0, 3.0], 1e-12).unwrap();
/// assert!((x - dvector![1.0, 1.0]).norm() < 1e-14);
/// ```
pub fn least_squares(a: DMatrix<f64>, b: &DVector<f64>, least: f64) -> Option<DVector<f64>> {
    singular(a).map(|singular| singular.pseudo_inverse(least) * b)
}
