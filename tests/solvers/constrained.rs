//! Quadratic programmes with bounds: pivoting beside the interior point.

use springfit::fit::Rank;
use springfit::fit::solvers::{Normal, interior_point, solve_nonnegative};

/// Random positive definite problems with mixed signs: both methods agree to what the interior point is asked for,
/// and the pivoted point satisfies `k ≥ 0`, `Mk − b ≥ 0`, `k (Mk − b) = 0`.
#[test]
fn pivoting_finds_the_optimum_of_the_conic_solver() {
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut bound = 0;
    for m in (1..12).flat_map(|m| [m; 10]).chain([24, 27, 40, 61]) {
        let g: Vec<f64> = (0..m * (m + 2)).map(|_| random()).collect();
        let rows: Vec<&[f64]> = g.chunks_exact(m + 2).collect();
        let dot = |s: usize, t: usize| rows[s].iter().zip(rows[t]).map(|(a, b)| a * b).sum::<f64>();
        let gram = (0..m * m).map(|st| dot(st / m, st % m)).collect();
        let normal = Normal::new(gram, (0..m).map(|_| random()).collect());
        let (k, rank) = solve_nonnegative(&normal);
        assert_eq!(rank, Rank::Full);
        for (k, slope) in k.iter().zip(normal.gradient(&k)) {
            assert!(*k >= 0.0 && slope > -1e-9 && (k * slope).abs() < 1e-9, "{k} {slope}");
            bound += usize::from(*k == 0.0);
        }
        let reference = interior_point(&normal).unwrap();
        let largest = k.iter().fold(1.0f64, |a, k| a.max(*k));
        assert!(k.iter().zip(&reference).all(|(a, b)| (a - b).abs() < 1e-5 * largest), "{k:?} {reference:?}");
    }
    assert!(bound > 100, "the bound was hardly ever active");
}
