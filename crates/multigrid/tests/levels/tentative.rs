//! The motions that aggregates carry.

use springfit_multigrid::parts::{Aggregates, tentative};
use springfit_multigrid::space_motions;

/// The span of aggregates with less than three points that are not on a line has not all six motions.
#[test]
fn the_basis_is_orthonormal_and_spans_the_motions_whatever_the_points() {
    let shapes: [(&[f64], usize); 3] = [
        (&[0.3, 0.1, 5.0], 3),
        (&[0.0, 0.0, 0.0, 1.0, 2.0, 3.0], 5),
        (&[0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 0.5, -1.0, 2.0, 4.0, 4.0, 0.0], 6),
    ];
    for (points, rank) in shapes {
        let n = points.len() / 3;
        let motions = space_motions(points, &vec![false; 3 * n]);
        let t = tentative(&Aggregates { of: vec![0; n], count: 1 }, &motions);
        assert_eq!(t.is_held[0].iter().filter(|held| !**held).count(), rank);
        for a in 0..6 {
            for b in 0..6 {
                let product: f64 = t.basis.iter().flatten().map(|row| row[a] * row[b]).sum();
                let expected = f64::from(u8::from(a == b && !t.is_held[0][a]));
                assert!((product - expected).abs() < 1e-12, "q_{a}·q_{b} = {product}");
            }
        }
        for (motion, basis) in motions.iter().zip(&t.basis) {
            for i in 0..3 {
                for j in 0..6 {
                    let again: f64 = (0..6).map(|k| basis[i][k] * t.motions[0][k][j]).sum();
                    assert!((again - motion[i][j]).abs() < 1e-7, "B = T B_c");
                }
            }
        }
    }
}
