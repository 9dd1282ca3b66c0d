//! Singular values and vectors beside their definition, of matrices for which another decomposition is wrong among them.

use crate::shapes::Random;
use nalgebra::{DMatrix, DVector};
use springfit_numerics::dense::{least_squares, singular};

/// Random numbers, small integers, zeros and ones, products of few ranks, and values that are given: repeated, vanishing and far apart.
fn matrices() -> Vec<(String, DMatrix<f64>)> {
    let mut random = Random(23);
    let mut all = vec![
        // Without repeated values, and of full rank.
        (
            "a small integer one".into(),
            DMatrix::from_row_slice(3, 3, &[1.0, 2.0, 2.0, 2.0, -1.0, -1.0, 2.0, 1.0, -1.0]),
        ),
        ("zero".into(), DMatrix::zeros(3, 2)),
    ];
    for (m, n) in [(1, 1), (1, 4), (2, 2), (3, 3), (3, 5), (4, 3), (8, 4), (14, 4), (20, 10), (10, 20), (27, 8)] {
        all.push((format!("ones {m} × {n}"), DMatrix::from_element(m, n, 1.0)));
        for round in 0..40 {
            let mut named = |name: &str, a| all.push((format!("{name} {m} × {n}, {round}"), a));
            let mut fresh = |m, n| DMatrix::from_fn(m, n, |_, _| random.next());
            let a = fresh(m, n);
            named("integers", a.map(|x| (2.0 * x).round()));
            named("zeros and ones", a.map(|x| if x > 0.0 { 1.0 } else { 0.0 }));
            named("few ranks", fresh(m, m.min(n).div_ceil(2)) * fresh(m.min(n).div_ceil(2), n));
            let few = m.min(n);
            let (u, v) = (fresh(m, few).qr().q(), fresh(n, few).qr().q());
            let given = |value: &dyn Fn(usize) -> f64| {
                &u * DMatrix::from_diagonal(&DVector::from_fn(few, |i, _| value(i))) * v.transpose()
            };
            named("repeated", given(&|i| 1.0 + (i / 2) as f64));
            named("far apart", given(&|i| 10f64.powi(-3 * i as i32)));
            named("huge", given(&|i| 1e250 * (1 + i) as f64));
            named("tiny", given(&|i| 1e-250 * (1 + i) as f64));
            named("random", a);
        }
    }
    all
}

#[test]
fn products_of_the_factors_are_the_matrix() {
    for (name, a) in matrices() {
        let size = a.amax().max(f64::MIN_POSITIVE);
        let found = singular(a.clone()).unwrap();
        let (n, v) = (a.ncols(), &found.v);
        let (a, scaled, values) = (a / size, &found.scaled / size, &found.values / size);
        let rounding = 1e-14 * values[0];
        assert!((&scaled * v.transpose() - &a).norm() <= rounding, "{name}");
        assert!((v.transpose() * v - DMatrix::identity(n, n)).norm() < 1e-13, "{name}");
        let square = DMatrix::from_diagonal(&values.map(|value| value * value));
        assert!((scaled.transpose() * scaled - square).amax() <= 1e-14 * values[0].powi(2), "{name}");
        assert!(values.as_slice().is_sorted_by(|a, b| a >= b), "{name}");
        // Those of nalgebra without vectors, which are right where all numbers are finite.
        #[expect(clippy::disallowed_methods, reason = "it is what they are compared with")]
        let mut known = a.singular_values().as_slice().to_vec();
        known.resize(n, 0.0);
        assert!((values - DVector::from_vec(known)).amax() <= rounding, "{name}");
    }
}

/// `A A⁺ A = A` and `A⁺ A A⁺ = A⁺`, with symmetric products, define it (R. Penrose, *A generalized inverse for matrices*, 1955).
#[test]
fn pseudo_inverses_are_those_of_penrose() {
    for (name, a) in matrices() {
        let a = &a / a.amax().max(f64::MIN_POSITIVE);
        let found = singular(a.clone()).unwrap();
        let rank = found.rank(1e-8);
        let inverse = found.pseudo_inverse(1e-8);
        let (left, right) = (&a * &inverse, &inverse * &a);
        // Values below the cut are not inverted; the others lose digits with their ratio.
        let least = if rank == 0 { 1.0 } else { found.values[rank - 1] };
        let lost = 1e-14 * (1.0 + found.values[0] / least);
        let below = found.values.iter().skip(rank).fold(0.0, |most: f64, value| most.max(*value));
        assert!((&left * &a - &a).norm() <= 3.0 * below + lost * a.norm(), "{name}");
        assert!((&right * &inverse - &inverse).norm() <= lost * inverse.norm(), "{name}");
        for product in [&left, &right] {
            assert!(
                (product - product.transpose()).norm() <= lost,
                "{name}: {:e}",
                (product - product.transpose()).norm()
            );
            assert!((product.trace() - rank as f64).abs() < lost.max(1e-12), "{name}");
        }
    }
    let tiny = singular(DMatrix::identity(2, 2) * 1e-250).unwrap().pseudo_inverse(1e-8);
    assert!((tiny * 1e-250 - DMatrix::identity(2, 2)).norm() < 1e-15);
}

#[test]
fn numbers_that_are_not_finite_have_no_solution() {
    for wrong in [f64::NAN, f64::INFINITY] {
        let a = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, wrong]));
        assert!(singular(a.clone()).is_none() && least_squares(a, &DVector::zeros(2), 0.0).is_none());
    }
}
