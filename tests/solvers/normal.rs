//! Normal equations, regular and singular.

use springfit_fit::fit::Rank;
use springfit_fit::fit::solvers::Normal;

/// `k = (1, 2)` for a regular matrix, `(1, 1)` where only the sum of the two is determined.
#[test]
fn solves_and_tells_the_rank() {
    let (k, rank) = Normal::new(vec![4.0, 1.0, 1.0, 3.0], vec![6.0, 7.0]).solve();
    assert_eq!(rank, Rank::Full);
    assert!((k[0] - 1.0).abs() < 1e-15 && (k[1] - 2.0).abs() < 1e-15);
    let (k, rank) = Normal::new(vec![4.0; 4], vec![8.0; 2]).solve();
    assert_eq!(rank, Rank::Deficient);
    assert!(k.iter().all(|k| (k - 1.0).abs() < 1e-14));
}
