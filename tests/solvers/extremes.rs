//! The 2-norm of symmetric matrices beside an eigensolver.

use crate::shapes::Random;
use nalgebra::DMatrix;
use springfit_fit::fit::solvers::Extremes;

fn norm(matrix: &DMatrix<f64>) -> f64 {
    let n = matrix.nrows();
    Extremes::like(&0.0, n).norm(&mut matrix.as_slice().to_vec()[..n * n])
}

#[test]
fn the_norm_is_that_of_an_eigensolver() {
    let mut random = Random(7);
    for n in 1..=30 {
        for round in 0..20 {
            let a = DMatrix::from_fn(n, n, |_, _| random.next());
            let mut matrix = &a + a.transpose();
            if round % 4 == 1 {
                // Few ranks, as springs have.
                let v = DMatrix::from_fn(n, 1 + n / 4, |_, _| random.next());
                matrix = &v * v.transpose() * 1e9;
            }
            if round % 4 == 2 {
                // Multiple eigenvalues at an end.
                let q = a.qr().q();
                let d = DMatrix::from_fn(n, n, |i, j| if i == j { if i < n.min(3) { -2.0 } else { 1.0 } } else { 0.0 });
                matrix = &q * d * q.transpose() * 1e-9;
            }
            let known = matrix.clone().symmetric_eigenvalues().amax();
            let found = norm(&matrix);
            assert!((found - known).abs() <= 1e-12 * known * n as f64, "{n} {round}: {found:e} {known:e}");
        }
    }
}

#[test]
fn diagonal_and_zero_matrices_are_no_exception() {
    assert_eq!(norm(&DMatrix::zeros(5, 5)), 0.0);
    for n in [1, 2, 12] {
        let identity = DMatrix::<f64>::identity(n, n) * -3.0;
        assert!((norm(&identity) - 3.0).abs() < 1e-12, "{}", norm(&identity));
    }
    assert!(norm(&DMatrix::from_element(4, 4, f64::NAN)).is_nan());
}
