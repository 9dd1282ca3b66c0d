//! Quadratic programmes with bounds: the conditions of optimality, and the least norm where there are many optima.

use kinds::Kind;
use springfit::fit::Rank;
use springfit::fit::solvers::{Normal, solve_nonnegative};

mod kinds;

/// The largest violation of `M k − b ≥ 0` and `k (M k − b) = 0`, in the scaling with a unit diagonal, as a share of the largest |b|. A
/// constant that is not finite or below zero violates everything.
fn violation(normal: &Normal, k: &[f64]) -> f64 {
    if !k.iter().all(|k| *k >= 0.0 && k.is_finite()) {
        return f64::INFINITY;
    }
    let scale: Vec<f64> = (0..k.len()).map(|s| normal.entry(s, s).sqrt().recip()).collect();
    let largest = normal.rhs.iter().zip(&scale).fold(0.0f64, |largest, (b, s)| largest.max((b * s).abs()));
    let slopes = normal.gradient(k).into_iter().zip(k).zip(&scale);
    slopes.map(|((slope, k), s)| s * if *k > 0.0 { slope.abs() } else { -slope }).fold(0.0, f64::max)
        / if largest > 0.0 { largest } else { 1.0 }
}

/// 4 000 problems of 1 to 40 unknowns. They are drawn from random rows, from fewer rows than unknowns, with repeated springs, with springs that
/// are sums of others, and with sizes from 1e-6 to 1e6.
#[test]
fn four_thousand_optima_satisfy_their_conditions() {
    let (mut worst, mut bound, mut deficient) = (0.0f64, 0, 0);
    for number in 0..4000 {
        let normal = Kind::of(number).problem(number);
        let (k, rank) = solve_nonnegative(&normal);
        assert_ne!(rank, Rank::Unsolved, "problem {number}");
        let violation = violation(&normal, &k);
        assert!(violation <= 1e-10, "problem {number}: {violation:e} {k:?}");
        worst = worst.max(violation);
        bound += k.iter().filter(|k| **k == 0.0).count();
        deficient += usize::from(rank == Rank::Deficient);
    }
    println!("largest violation {worst:.1e} of the largest |b|; {deficient} problems with many optima");
    assert!(bound > 20_000 && deficient > 1500, "{bound} {deficient}");
}

/// Of many optima the one of least norm, in the scaling with a unit diagonal, is unique: with `k*` that optimum, `k*·k ≥ |k*|²` for every
/// other optimum k, and others are found in the order in which springs are listed.
#[test]
fn of_many_optima_the_smallest_constants_are_found() {
    let mut compared = 0;
    for number in 4..1000 {
        let normal = Kind::of(number).problem(number);
        let (k, rank) = solve_nonnegative(&normal);
        if rank != Rank::Deficient {
            continue;
        }
        let m = k.len();
        let free = normal.least_norm();
        let scaled = |k: &[f64]| -> f64 { k.iter().enumerate().map(|(s, k)| k * k * normal.entry(s, s)).sum() };
        if free.iter().all(|k| *k >= 0.0) {
            let distance: Vec<f64> = k.iter().zip(&free).map(|(a, b)| a - b).collect();
            assert!(scaled(&distance).sqrt() <= 1e-7 * scaled(&free).sqrt(), "problem {number}: {k:?} {free:?}");
        }
        // Optima of problems whose cost is not the same: `δ |k − c|²` is added, c random, so that one optimum is picked.
        for trial in 0..4u64 {
            let mut random = kinds::random(number as u64 * 7 + trial);
            let delta = 1e-7;
            let mut gram = vec![0.0; m * m];
            let mut rhs = vec![0.0; m];
            for s in 0..m {
                (0..m).for_each(|t| gram[s * m + t] = normal.entry(s, t));
                gram[s * m + s] *= 1.0 + delta;
                let pulled = scaled(&k).sqrt() * random() / normal.entry(s, s).sqrt();
                rhs[s] = normal.rhs[s] + delta * normal.entry(s, s) * pulled;
            }
            let (other, _) = solve_nonnegative(&Normal::new(gram, rhs));
            assert!(scaled(&k) <= scaled(&other) * (1.0 + 1e-5), "problem {number}: {k:?} {other:?}");
            compared += 1;
        }
    }
    assert!(compared > 1000, "{compared}");
}
