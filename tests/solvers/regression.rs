//! Fits in the 1-norm, the maximum norm and Huber's function reach their optimum, whatever the columns.

use crate::shapes::Random;
use nalgebra::{DMatrix, DVector};
use springfit_fit::fit::Norm;
use springfit_fit::fit::solvers::solve_norm;

const NORMS: [Norm; 5] = [Norm::Two, Norm::One, Norm::Max, Norm::Huber { share: 0.1 }, Norm::Huber { share: 1.0 }];

struct Problem {
    a: DMatrix<f64>,
    b: DVector<f64>,
    planted: Vec<f64>,
}

impl Problem {
    /// Equations of planted unknowns with noise; every seventh right-hand side is off by up to `outlier`.
    fn random(m: usize, n: usize, noise: f64, outlier: f64) -> Problem {
        let mut random = Random((m * n) as u64);
        let a = DMatrix::from_fn(m, n, |_, _| random.next());
        let planted: Vec<f64> = (0..n).map(|_| random.next()).collect();
        let mut b = &a * DVector::from_column_slice(&planted);
        b.iter_mut().for_each(|b| *b += noise * random.next());
        b.iter_mut().step_by(7).for_each(|b| *b += outlier * random.next());
        Problem { a, b, planted }
    }

    /// Every other entry is zero.
    fn half_dense(m: usize, n: usize, noise: f64, outlier: f64) -> Problem {
        let mut problem = Problem::random(m, n, noise, outlier);
        let planted = &problem.a * DVector::from_column_slice(&problem.planted);
        problem.b -= planted;
        (0..m * n).filter(|ij| (ij / n + ij % n) % 2 == 1).for_each(|ij| problem.a[(ij / n, ij % n)] = 0.0);
        problem.b += &problem.a * DVector::from_column_slice(&problem.planted);
        problem
    }

    fn solve(&self, norm: Norm, nonnegative: bool) -> DVector<f64> {
        let rows = self.a.transpose();
        let x = solve_norm(rows.as_slice(), self.b.as_slice(), self.a.ncols(), norm, nonnegative);
        let x = DVector::from_vec(x.unwrap_or_else(|| panic!("{norm:?} of {:?} is not solved", self.a.shape())));
        assert!(!nonnegative || x.min() >= 0.0);
        x
    }

    fn residual(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.b - &self.a * x
    }

    fn root_mean_square(&self) -> f64 {
        self.b.norm() / (self.b.len() as f64).sqrt()
    }

    fn value(&self, x: &DVector<f64>, norm: Norm) -> f64 {
        let r = self.residual(x);
        match norm {
            Norm::Two => r.norm_squared(),
            Norm::One => r.lp_norm(1),
            Norm::Max => r.amax(),
            Norm::Huber { share } => {
                let delta = share * self.root_mean_square();
                let huber = |r: f64| if r < delta { r * r / 2.0 } else { delta * (r - delta / 2.0) };
                r.iter().map(|r| huber(r.abs())).sum()
            }
        }
    }

    /// The unknowns that are not at their bound.
    fn free(&self, x: &DVector<f64>, nonnegative: bool) -> Vec<usize> {
        (0..x.len()).filter(|&j| !nonnegative || x[j] > 1e-6).collect()
    }

    /// The `y` that is `known` but for the `active` entries, which make it orthogonal to the free columns; where
    /// `signs` are given, those entries also have `Σ sign y = 1`.
    fn dual(&self, active: &[usize], free: &[usize], signs: Option<&[f64]>, known: DVector<f64>) -> DVector<f64> {
        let columns = self.a.select_columns(free);
        let mut rhs = (-columns.tr_mul(&known)).as_slice().to_vec();
        let mut matrix = columns.select_rows(active).transpose();
        if let Some(signs) = signs {
            matrix = matrix.insert_row(free.len(), 0.0);
            matrix.row_mut(free.len()).copy_from_slice(signs);
            rhs.push(1.0);
        }
        assert!(matrix.is_square(), "{} active equations, {} unknowns", active.len(), free.len());
        let solved = matrix.lu().solve(&DVector::from_vec(rhs)).unwrap();
        let mut y = known;
        active.iter().zip(&solved).for_each(|(&i, value)| y[i] = *value);
        y
    }

    /// `Aᵀy = 0`, or `≤ 0` where the unknown is at its bound: with the bounds on `y` this makes `bᵀy` a lower bound.
    fn assert_dual_feasible(&self, y: &DVector<f64>, free: &[usize], tolerance: f64) {
        let slope = self.a.tr_mul(y);
        for j in 0..slope.len() {
            assert!(slope[j] < tolerance && (slope[j] > -tolerance || !free.contains(&j)), "{j}: {}", slope[j]);
        }
    }
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * b.abs().max(1e-300)
}

#[test]
fn one_column_of_ones_gives_median_middle_mean_and_a_clipped_mean() {
    let b = [0.0, 0.0, 1.0, 3.0, 10.0];
    let location =
        |norm, nonnegative, sign: f64| solve_norm(&[1.0; 5], &b.map(|b| sign * b), 1, norm, nonnegative).unwrap()[0];
    // ψ sums to zero: −x − x + (1 − x) + (3 − x) + δ with δ = 2.
    let share = 2.0 / 22f64.sqrt();
    let expected = [(Norm::One, 1.0), (Norm::Max, 5.0), (Norm::Two, 2.8), (Norm::Huber { share }, 1.5)];
    for (norm, x) in expected {
        assert!((location(norm, false, 1.0) - x).abs() < 1e-8, "{norm:?} {}", location(norm, false, 1.0));
        assert!((location(norm, false, -1.0) + x).abs() < 1e-8);
        assert!((location(norm, true, 1.0) - x).abs() < 1e-8);
        assert!((0.0..1e-8).contains(&location(norm, true, -1.0)));
    }
}

/// A dual point that satisfies its constraints to rounding and has the value of `x` proves both optimal.
#[test]
fn the_sum_of_absolute_residuals_equals_its_dual_bound() {
    for (m, n) in [(40, 3), (300, 6), (900, 20), (3000, 40)] {
        for (nonnegative, outlier) in [(false, 5.0), (true, 5.0), (false, 1e4)] {
            let problem = Problem::half_dense(m, n, 0.3, outlier);
            let x = problem.solve(Norm::One, nonnegative);
            let r = problem.residual(&x);
            let free = problem.free(&x, nonnegative);
            let mut active: Vec<usize> = (0..m).collect();
            active.sort_by(|&a, &b| r[a].abs().total_cmp(&r[b].abs()));
            active.truncate(free.len());
            let known = DVector::from_fn(m, |i, _| if active.contains(&i) { 0.0 } else { r[i].signum() });
            let y = problem.dual(&active, &free, None, known);
            assert!(y.amax() < 1.0 + 1e-9, "{}", y.amax());
            problem.assert_dual_feasible(&y, &free, 1e-9 * m as f64);
            assert!(close(problem.b.dot(&y), r.lp_norm(1), 1e-10), "{} {}", problem.b.dot(&y), r.lp_norm(1));
            assert!(!nonnegative || free.len() < n, "the bound was not active");
        }
    }
}

#[test]
fn the_largest_residual_equals_its_dual_bound() {
    for (m, n) in [(40, 3), (300, 6), (900, 20), (12000, 20)] {
        for (nonnegative, outlier) in [(false, 5.0), (true, 5.0), (false, 1e6)] {
            let problem = Problem::random(m, n, 0.3, outlier);
            let x = problem.solve(Norm::Max, nonnegative);
            let r = problem.residual(&x);
            let most = r.amax();
            let active: Vec<usize> = (0..m).filter(|&i| r[i].abs() > most * (1.0 - 1e-8)).collect();
            let signs: Vec<f64> = active.iter().map(|&i| r[i].signum()).collect();
            let free = problem.free(&x, nonnegative);
            let y = problem.dual(&active, &free, Some(&signs), DVector::zeros(m));
            assert!(active.iter().zip(&signs).all(|(&i, sign)| sign * y[i] > -1e-12));
            problem.assert_dual_feasible(&y, &free, 1e-12);
            assert!(close(problem.b.dot(&y), most, 1e-9), "{} {most}", problem.b.dot(&y));
            assert!(!nonnegative || free.len() < n, "the bound was not active");
        }
    }
}

/// The slope `Aᵀψ(r)` vanishes, or is negative where the unknown is at its bound.
#[test]
fn hubers_function_is_stationary() {
    for (m, n, outlier) in [(40, 3, 5.0), (900, 20, 5.0), (3000, 40, 5.0), (900, 20, 1e4)] {
        for share in [1e-3, 0.1, 1.0, 10.0, f64::INFINITY] {
            for nonnegative in [false, true] {
                let problem = Problem::half_dense(m, n, 0.3, outlier);
                let x = problem.solve(Norm::Huber { share }, nonnegative);
                let delta = share * problem.root_mean_square();
                let psi = problem.residual(&x).map(|r| r.clamp(-delta, delta));
                let tolerance = 1e-8 * m as f64 * problem.root_mean_square();
                problem.assert_dual_feasible(&psi, &problem.free(&x, nonnegative), tolerance);
            }
        }
    }
}

#[test]
fn hubers_function_tends_to_least_squares_and_to_the_sum_of_absolute_residuals() {
    let problem = Problem::random(600, 12, 0.3, 5.0);
    let (q, r) = problem.a.clone().qr().unpack();
    let squares = r.solve_upper_triangular(&q.tr_mul(&problem.b)).unwrap();
    for norm in [Norm::Two, Norm::Huber { share: 1e9 }, Norm::Huber { share: f64::INFINITY }] {
        assert!((problem.solve(norm, false) - &squares).amax() < 1e-8, "{norm:?}");
    }
    let absolute = problem.solve(Norm::One, false);
    assert!((problem.solve(Norm::Huber { share: 0.0 }, false) - &absolute).amax() < 1e-8);
    assert!((problem.solve(Norm::Huber { share: 1e-6 }, false) - &absolute).amax() < 1e-4);
    assert!((squares - absolute).amax() > 0.01, "nothing to tell them apart");
}

#[test]
fn gross_outliers_do_not_move_an_otherwise_exact_fit_in_the_one_norm() {
    for outlier in [5.0, 1e4, 1e8] {
        let problem = Problem::random(700, 15, 0.0, outlier);
        let planted = DVector::from_column_slice(&problem.planted);
        let error = (problem.solve(Norm::One, false) - &planted).amax();
        assert!(error < 1e-10 * outlier, "{error}");
        assert!((problem.solve(Norm::Two, false) - &planted).amax() > 0.01);
    }
}

/// Only the sign of its residual counts, not the size, however little that leaves of the others beside it.
#[test]
fn the_size_of_an_outlier_does_not_matter_in_the_one_norm() {
    for (m, n) in (20..70).map(|m| (m, 1 + m % 5)) {
        let mut problem = Problem::random(m, n, 0.3, 0.0);
        problem.a.row_mut(0).scale_mut(0.1);
        problem.b[0] = 1e3;
        let x = problem.solve(Norm::One, false);
        problem.b[0] = 1e7;
        assert!((problem.solve(Norm::One, false) - x).amax() < 1e-3, "{m} × {n}");
    }
}

/// `T₆ / 32` is the monic polynomial of least maximum; its extrema are among the points.
#[test]
fn the_best_polynomial_leaves_chebyshevs() {
    let m = 6001;
    let t = |i: usize| (std::f64::consts::PI * i as f64 / 6000.0).cos();
    let a = DMatrix::from_fn(m, 6, |i, j| t(i).powi(j as i32));
    let problem = Problem { a, b: DVector::from_fn(m, |i, _| t(i).powi(6)), planted: vec![] };
    let x = problem.solve(Norm::Max, false);
    assert!(close(problem.value(&x, Norm::Max), 1.0 / 32.0, 1e-9), "{}", problem.value(&x, Norm::Max) * 32.0);
    let expected = [1.0 / 32.0, 0.0, -18.0 / 32.0, 0.0, 48.0 / 32.0, 0.0];
    assert!(x.iter().zip(expected).all(|(x, e)| (x - e).abs() < 1e-7), "{x}");
}

/// A column that adds nothing changes no optimum: an equal, an opposite, an empty, and a combination to rounding.
#[test]
fn dependent_columns_do_not_fail() {
    let problem = Problem::random(500, 8, 0.3, 5.0);
    let (first, second) = (problem.a.column(0).into_owned(), problem.a.column(1).into_owned());
    let mut random = Random(1);
    let combination = DVector::from_fn(500, |i, _| (2.0 * first[i] - second[i]) * (1.0 + 1e-14 * random.next()));
    for (norm, nonnegative) in NORMS.iter().flat_map(|&norm| [(norm, false), (norm, true)]) {
        let value = problem.value(&problem.solve(norm, nonnegative), norm);
        for added in [first.clone(), -&first, 0.0 * &first, combination.clone()] {
            let mut columns: Vec<DVector<f64>> = problem.a.column_iter().map(|c| c.into_owned()).collect();
            columns.push(added.clone());
            let extended = Problem { a: DMatrix::from_columns(&columns), b: problem.b.clone(), planted: vec![] };
            let x = extended.solve(norm, nonnegative);
            let reached = extended.value(&x, norm);
            // With x ≥ 0, an opposite or a combination with negative weights is a gain.
            let gains = nonnegative && (added == -&first || added == combination);
            assert!(close(reached, value, 1e-8) || gains && reached < value, "{norm:?}: {reached} {value}");
            assert!(nonnegative || added != first || (x[0] - x[8]).abs() < 1e-8, "{norm:?}: not the least norm");
        }
    }
}

/// Columns 1e-7 apart: as they are, Clarabel calls values solved that are percents above the optimum, or gives up.
#[test]
fn nearly_dependent_columns_reach_the_optimum() {
    for (m, n) in (20..80).map(|m| (m, 3 + m % 4)) {
        let reference = Problem::random(m, n, 0.3, 5.0);
        let mut a = reference.a.clone();
        a.set_column(n - 1, &(reference.a.column(0) + 1e-7 * reference.a.column(n - 1)));
        let problem = Problem { a, b: reference.b.clone(), planted: vec![] };
        for norm in NORMS {
            let expected = reference.value(&reference.solve(norm, false), norm);
            let reached = problem.value(&problem.solve(norm, false), norm);
            assert!(close(reached, expected, 1e-7), "{m} × {n} {norm:?}: {reached} {expected}");
        }
    }
}

/// Twelve columns that are combinations of five.
#[test]
fn the_rank_decides_what_can_be_reached() {
    let reference = Problem::random(200, 5, 0.3, 5.0);
    let mut random = Random(3);
    let mut a = &reference.a * DMatrix::from_fn(5, 12, |_, _| random.next());
    a.column_iter_mut().for_each(|mut column| _ = column.normalize_mut());
    let problem = Problem { a, b: reference.b.clone(), planted: vec![] };
    for norm in NORMS {
        let expected = reference.value(&reference.solve(norm, false), norm);
        let x = problem.solve(norm, false);
        assert!(close(problem.value(&x, norm), expected, 1e-8), "{norm:?}");
        let rows = problem.a.transpose().col_piv_qr().q().columns(0, 5).into_owned();
        assert!((&rows * rows.tr_mul(&x) - &x).amax() < 1e-9, "{norm:?}: not the least norm");
    }
}

#[test]
fn fewer_equations_than_unknowns_are_met() {
    let problem = Problem::random(9, 20, 0.3, 5.0);
    for norm in NORMS {
        assert!(problem.residual(&problem.solve(norm, false)).amax() < 1e-8, "{norm:?}");
    }
}

#[test]
fn units_of_equations_and_unknowns_do_not_matter() {
    let Problem { mut a, b, .. } = Problem::random(300, 6, 0.3, 5.0);
    let problem = Problem { a: a.clone(), b: b.clone(), planted: vec![] };
    (0..6).for_each(|j| a.column_mut(j).scale_mut(10f64.powi(40 * j as i32 - 100)));
    let scaled = Problem { a, b: b * 1e-180, planted: vec![] };
    for (norm, nonnegative) in NORMS.iter().flat_map(|&norm| [(norm, false), (norm, true)]) {
        let (x, mut y) = (problem.solve(norm, nonnegative), scaled.solve(norm, nonnegative));
        (0..6).for_each(|j| y[j] *= 10f64.powi(40 * j as i32 - 100) * 1e180);
        assert!((&x - &y).amax() < 1e-7, "{norm:?} {x} {y}");
    }
}

#[test]
fn what_cannot_be_solved_is_refused_and_what_is_trivial_is_zero() {
    let (a, b) = ([1.0, 2.0, 3.0, 4.0], [1.0, 2.0]);
    assert_eq!(solve_norm(&[1.0, f64::NAN, 3.0, 4.0], &b, 2, Norm::One, false), None);
    assert_eq!(solve_norm(&a, &[f64::INFINITY, 1.0], 2, Norm::Max, true), None);
    assert_eq!(solve_norm(&a, &b, 2, Norm::Huber { share: -0.1 }, false), None);
    assert_eq!(solve_norm(&a, &b, 2, Norm::Huber { share: f64::NAN }, false), None);
    for norm in NORMS {
        assert_eq!(solve_norm(&a, &[0.0; 2], 2, norm, false), Some(vec![0.0; 2]));
        assert_eq!(solve_norm(&[0.0; 4], &b, 2, norm, true), Some(vec![0.0; 2]));
        assert_eq!(solve_norm(&[], &[], 2, norm, false), Some(vec![0.0; 2]));
        assert_eq!(solve_norm(&[], &b, 0, norm, false), Some(vec![]));
    }
}
