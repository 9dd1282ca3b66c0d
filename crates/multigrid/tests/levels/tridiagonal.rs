//! Extreme eigenvalues of tridiagonal matrices.

use springfit_multigrid::parts::Tridiagonal;
use std::f64::consts::PI;

/// `2 − 2 cos(π k / (n + 1))`, the eigenvalues of the second difference.
#[test]
fn the_extremes_are_those_of_the_second_difference() {
    for n in [1, 2, 7, 40] {
        let t = Tridiagonal { diagonal: vec![2.0; n], beside: vec![-1.0; n - 1] };
        let exact = |k: usize| 2.0 - 2.0 * (PI * k as f64 / (n + 1) as f64).cos();
        let [low, high] = t.extremes().unwrap();
        assert!((low - exact(1)).abs() < 1e-13 && (high - exact(n)).abs() < 1e-13);
    }
    assert_eq!(Tridiagonal::default().extremes(), None);
}
