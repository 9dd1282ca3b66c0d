//! Dense matrices whose size is the caller's, such as the stiffness of a small network.
//!
//! A generic function is compiled, and optimised, with the package that calls it. These are compiled here, so that callers whose own code is
//! not optimised run them at full speed.

use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};

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

/// The x of least norm that minimises ‖A x − b‖, by the singular values σ of A; those of at most `epsilon` count as zero. `None` if they do not
/// converge. It is done in n³ operations.
///
/// ```
/// use nalgebra::{dmatrix, dvector};
/// let x = springfit_numerics::dense::least_squares(dmatrix![1.0, 1.0; 1.0, 1.0], &dvector![1.0, 3.0], 1e-12).unwrap();
/// assert!((x - dvector![1.0, 1.0]).norm() < 1e-14);
/// ```
pub fn least_squares(a: DMatrix<f64>, b: &DVector<f64>, epsilon: f64) -> Option<DVector<f64>> {
    a.svd(true, true).solve(b, epsilon).ok()
}
