//! Quadratic programmes with bounds: the conditions of optimality, and the least norm where there are many optima.

use kinds::Kind;
use springfit_fit::fit::Rank;
use springfit_fit::fit::solvers::{Normal, solve_nonnegative};

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

/// Motions along which the objective is flat, known from how columns repeat or add up, do not shorten the constants in the scaling with a unit
/// diagonal, in either sense that keeps them from going below zero.
#[test]
fn of_many_optima_the_smallest_constants_are_found() {
    let (mut free, mut at_bounds) = (0, 0);
    for number in 0..4000 {
        let normal = Kind::of(number).problem(number);
        let (k, _) = solve_nonnegative(&normal);
        let size = |k: &[f64]| k.iter().enumerate().map(|(s, k)| k * k * normal.entry(s, s)).sum::<f64>().sqrt();
        for motion in Kind::of(number).flat_motions(number) {
            let along: f64 = motion.iter().zip(&k).enumerate().map(|(s, (n, k))| n * k * normal.entry(s, s)).sum();
            let slope = along / (size(&motion) * size(&k)).max(f64::MIN_POSITIVE);
            // A constant of 1e-5 of all may be rounding, along which there is no way.
            let is_above = |s: usize| k[s] * normal.entry(s, s).sqrt() > 1e-5 * size(&k);
            let stays = |sign: f64| motion.iter().enumerate().all(|(s, n)| sign * n >= 0.0 || is_above(s));
            assert!(!stays(1.0) || slope >= -1e-5, "problem {number}: {slope:e} {k:?}");
            assert!(!stays(-1.0) || slope <= 1e-5, "problem {number}: {slope:e} {k:?}");
            free += usize::from(stays(1.0) && stays(-1.0));
            at_bounds += usize::from(stays(1.0) != stays(-1.0));
        }
    }
    assert!(free > 5000 && at_bounds > 500, "{free} {at_bounds}");
}
