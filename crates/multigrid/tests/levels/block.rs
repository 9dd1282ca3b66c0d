//! Inverses and softest motions of small blocks.

use springfit_multigrid::Block;
use springfit_multigrid::parts::{inverse, softest};

const A: Block<3, 3> = [[4.0, 1.0, -2.0], [1.0, 5.0, 0.5], [-2.0, 0.5, 3.0]];

#[test]
fn the_inverse_of_a_block_gives_the_identity_on_what_is_free() {
    for free in [[true; 3], [true, false, true]] {
        let inverse = inverse(&A, &free).unwrap();
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..3).filter(|k| free[*k]).map(|k| A[i][k] * inverse[k][j]).sum();
                let expected = f64::from(u8::from(i == j));
                if free[i] && free[j] {
                    assert!((product - expected).abs() < 1e-14);
                } else if !free[j] {
                    assert_eq!(inverse[i][j], 0.0);
                }
            }
        }
    }
}

#[test]
fn a_block_that_is_not_positive_definite_has_no_inverse_and_its_softest_motion_shows_it() {
    let a = [[1.0, 2.0], [2.0, 1.0]];
    assert_eq!(inverse(&a, &[true; 2]), None);
    let v = softest(&a, &[true; 2]);
    let energy: f64 = (0..2).flat_map(|i| (0..2).map(move |j| v[i] * a[i][j] * v[j])).sum();
    assert!((energy + 1.0).abs() < 1e-14, "the least eigenvalue is −1, found {energy}");
}
