//! Statistics of comparisons against enumeration, closed forms and figures of SciPy 1.17.

use crate::shapes::Random;
use springfit_studies::study::statistics::{
    Paired, Quantiles, Verdict, adjust, mean_ranks, median, median_interval, ratio_interval, signed_rank,
};

/// The probability by all signs of the ranks.
fn enumerated(differences: &[f64]) -> f64 {
    let n = differences.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| differences[*a].abs().total_cmp(&differences[*b].abs()));
    let found: usize = order.iter().enumerate().filter(|(_, d)| differences[**d] > 0.0).map(|(i, _)| i + 1).sum();
    let all = n * (n + 1) / 2;
    let least = found.min(all - found);
    let sum = |signs: u32| (0..n).filter(|i| signs >> i & 1 == 1).map(|i| i + 1).sum::<usize>();
    let below = (0..1u32 << n).filter(|signs| sum(*signs) <= least).count();
    (2.0 * below as f64 / f64::from(1u32 << n)).min(1.0)
}

#[test]
fn the_signed_rank_test_is_that_of_enumeration() {
    let mut random = Random(5);
    for n in 1..=12 {
        for _ in 0..20 {
            let differences: Vec<f64> = (0..n).map(|_| random.next() + 0.2).collect();
            let (found, known) = (signed_rank(&differences), enumerated(&differences));
            assert!((found - known).abs() < 1e-12, "{differences:?}: {found} for {known}");
        }
    }
}

#[test]
fn the_signed_rank_test_is_that_of_scipy() {
    let few = [0.3, -0.1, 0.7, 1.1, -0.4, 0.25, 0.9, -0.2, 0.05, 0.6];
    assert!((signed_rank(&few) - 0.10546875).abs() < 1e-12);
    let many: Vec<f64> = (0..60).map(|i| f64::from((37 * i) % 61 - 25) / 10.0).collect();
    assert!((signed_rank(&many) - 0.03968629824713282).abs() < 1e-12, "{}", signed_rank(&many));
    let tied: Vec<f64> = (0..60).map(|i| (f64::from((37 * i) % 61 - 22) / 10.0).round_ties_even()).collect();
    assert!((signed_rank(&tied) - 0.001357685247078072).abs() < 1e-12, "{}", signed_rank(&tied));
    assert_eq!(signed_rank(&[0.0, 0.0]), 1.0);
}

#[test]
fn quantiles_are_those_of_definition_seven() {
    let found = Quantiles::of(&[1.3, 2.1, 0.4, 8.0, 3.3, 5.9, 4.4]);
    let known = [0.4, 1.7, 3.3, 5.15, 7.37, 8.0];
    let found = [found.least, found.lower, found.median, found.upper, found.high, found.largest];
    found.iter().zip(known).for_each(|(found, known)| assert!((found - known).abs() < 1e-12, "{found} for {known}"));
}

/// Of normal samples the interval of 95 % holds the true median in about that share; and of two samples the ratio.
#[test]
fn bootstrap_intervals_cover_what_they_say() {
    let mut random = Random(11);
    // The sum of twelve uniform numbers is nearly normal.
    let mut draw = |mean: f64| mean + (0..12).map(|_| random.next()).sum::<f64>() / 4.0;
    let (mut covered, mut ratios) = (0, 0);
    for _ in 0..200 {
        let a: Vec<f64> = (0..40).map(|_| draw(10.0)).collect();
        let b: Vec<f64> = (0..40).map(|_| draw(8.0)).collect();
        covered += usize::from(median_interval(&a).has(10.0));
        ratios += usize::from(ratio_interval(&a, &b).has(1.25));
    }
    assert!((180..=198).contains(&covered) && (180..=199).contains(&ratios), "{covered} and {ratios} of 200");
}

#[test]
fn corrections_ranks_and_verdicts_follow_their_rules() {
    // Holm (1979): 3 p, 2 p, p from the least on, never below the one before.
    let adjusted = adjust(&[0.04, 0.01, 0.03]);
    let known = [0.06, 0.03, 0.06];
    adjusted.iter().zip(known).for_each(|(found, known)| assert!((found - known).abs() < 1e-15));
    let figures =
        [vec![Some(1.0), Some(3.0)], vec![Some(2.0), Some(3.0)], vec![Some(5.0), Some(1.0)], vec![Some(0.0), None]];
    assert_eq!(mean_ranks(&figures), [Some(1.75), Some(2.25), Some(2.0), None]);
    let a: Vec<f64> = (1..=50).map(f64::from).collect();
    let half: Vec<f64> = a.iter().map(|x| x / 2.0).collect();
    let pair = |first: &[f64], second: &[f64]| Paired::of(first, second).unwrap();
    let found = pair(&half, &a);
    assert!(found.wins == 50 && found.losses == 0 && (found.ratio - 0.5).abs() < 1e-12 && found.p < 1e-8);
    assert_eq!(found.verdict(found.p, 1), Verdict::First);
    assert_eq!(pair(&a, &half).verdict(found.p, 1), Verdict::Second);
    assert_eq!(pair(&a, &a).verdict(1.0, 1), Verdict::Tie);
    // Better by chance: half of the cases are better, the others worse by as much.
    let mixed: Vec<f64> = a.iter().enumerate().map(|(i, x)| if i % 2 == 0 { 2.0 * x } else { x / 2.0 }).collect();
    let found = pair(&mixed, &a);
    assert_eq!(found.verdict(found.p, 1), Verdict::Tie);
    // Five pairs tell nothing at 5 %, six do, and of ten comparisons each needs nine.
    for (count, made, known) in
        [(5, 1, Verdict::TooFew), (6, 1, Verdict::First), (8, 10, Verdict::TooFew), (9, 10, Verdict::First)]
    {
        let found = pair(&half[..count], &a[..count]);
        assert_eq!(found.verdict((found.p * made as f64).min(1.0), made), known, "{count} of {made}");
    }
    assert!(Paired::of(&[0.0], &[1.0]).is_none() && median(&[]).is_nan());
}
