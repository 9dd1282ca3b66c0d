//! Solutions are those of dense factors and of manufactured problems, at a cost that does not grow.

use super::elastic::{Body, Shape, random};
use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};
use proptest::prelude::*;
use springfit_multigrid::{Event, Fault, Multigrid, Settings, plane_motions, space_motions, unwatched};
use std::ops::ControlFlow;

/// The matrix on what is not held, with ones on the diagonal of what is.
fn dense<const D: usize>(body: &Body<D>) -> Mat<f64> {
    let matrix = body.matrix();
    let n = body.points.len();
    let mut all = Mat::zeros(n, n);
    for row in 0..matrix.rows() {
        for &column in matrix.pattern().row(row) {
            let block = matrix.values()[matrix.pattern().place(row, column as usize).unwrap()];
            for i in 0..D {
                for j in 0..D {
                    all[(row * D + i, column as usize * D + j)] = block[i][j];
                }
            }
        }
    }
    for i in (0..n).filter(|i| body.is_held[*i]) {
        (0..n).for_each(|j| (all[(i, j)], all[(j, i)]) = (0.0, 0.0));
        all[(i, i)] = 1.0;
    }
    all
}

fn exact<const D: usize>(body: &Body<D>, force: &[f64]) -> Vec<f64> {
    let factor = Llt::new(dense(body).as_ref(), Side::Lower).unwrap();
    let mut x = Mat::from_fn(force.len(), 1, |i, _| if body.is_held[i] { 0.0 } else { force[i] });
    factor.solve_in_place(x.as_mut());
    (0..force.len()).map(|i| x[(i, 0)]).collect()
}

fn difference(x: &[f64], y: &[f64]) -> f64 {
    let size = y.iter().map(|y| y * y).sum::<f64>().sqrt();
    x.iter().zip(y).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt() / size
}

fn forces(n: usize) -> Vec<f64> {
    let mut random = random(5);
    (0..n).map(|_| random()).collect()
}

/// The tolerance is that of the energy; the factor's own rounding is far below it.
#[test]
fn solutions_in_the_plane_are_those_of_a_dense_factor() {
    for (shape, poisson) in [(Shape::Cube, 0.3), (Shape::Simplex, 0.3), (Shape::Cube, 0.49), (Shape::Simplex, 0.0)] {
        let body = Body::<2>::new([23, 17], [1.0, 0.7], shape, 0.6, poisson);
        let force = forces(body.points.len());
        let levels = body.multigrid(&Settings { dense: 30, ..Settings::default() });
        assert!(levels.levels().len() > 2);
        let found = levels.solve(&force, 1e-11, 500, &mut unwatched).unwrap();
        assert!(difference(&found.displacement, &exact(&body, &force)) < 1e-9);
        assert!(found.residual < 1e-8);
    }
}

#[test]
fn solutions_in_space_are_those_of_a_dense_factor() {
    for (shape, stretch) in [(Shape::Cube, [1.0; 3]), (Shape::Simplex, [1.0; 3]), (Shape::Cube, [1.0, 1.0, 0.05])] {
        let body = Body::<3>::new([8, 7, 6], stretch, shape, 0.5, 0.3);
        let force = forces(body.points.len());
        let levels = body.multigrid(&Settings { dense: 100, ..Settings::default() });
        let found = levels.solve(&force, 1e-11, 500, &mut unwatched).unwrap();
        assert!(difference(&found.displacement, &exact(&body, &force)) < 1e-9);
    }
}

/// Symmetry planes hold one direction of a point, others hold none of it.
#[test]
fn points_may_be_held_in_some_directions_only() {
    let mut body = Body::<3>::new([7, 6, 5], [1.0; 3], Shape::Cube, 0.4, 0.3);
    for (x, held) in body.points.chunks_exact(3).zip(body.is_held.chunks_exact_mut(3)) {
        (0..3).for_each(|k| held[k] = x[k] == 0.0);
    }
    let force = forces(body.points.len());
    let levels = body.multigrid(&Settings { dense: 100, ..Settings::default() });
    let found = levels.solve(&force, 1e-11, 500, &mut unwatched).unwrap();
    assert!(difference(&found.displacement, &exact(&body, &force)) < 1e-9);
    assert!(body.is_held.iter().zip(&found.displacement).all(|(held, x)| !held || *x == 0.0));
}

/// `u = x² …` is given; the force is `A u`; what comes back is u.
#[test]
fn a_manufactured_displacement_comes_back() {
    let body = Body::<3>::new([14, 12, 10], [1.0; 3], Shape::Simplex, 0.4, 0.3);
    let wanted: Vec<[f64; 3]> = body
        .points
        .as_chunks::<3>()
        .0
        .iter()
        .map(|&[x, y, z]| [x * x - y * x, x * (0.3 * z).sin(), 0.1 * x * x * y])
        .collect();
    let mut force = vec![[0.0; 3]; wanted.len()];
    body.matrix().apply(&wanted, &mut force);
    let found = body.multigrid(&Settings::default()).solve(force.as_flattened(), 1e-12, 500, &mut unwatched).unwrap();
    assert!(difference(&found.displacement, wanted.as_flattened()) < 1e-10);
}

/// The goal is 20 at any size; a loss of it shows at these sizes already.
#[test]
fn the_number_of_iterations_does_not_grow_with_the_size() {
    for shape in [Shape::Cube, Shape::Simplex] {
        let count = |n: usize| {
            let body = Body::<3>::new([n; 3], [1.0; 3], shape, 0.4, 0.3);
            let force = forces(body.points.len());
            body.multigrid(&Settings::default()).solve(&force, 1e-8, 500, &mut unwatched).unwrap().iterations
        };
        let counts = [6, 12, 24].map(count);
        assert!(counts.iter().all(|count| *count <= 16), "{counts:?}");
    }
    let count = |n: usize| {
        let body = Body::<2>::new([n; 2], [1.0; 2], Shape::Simplex, 0.4, 0.3);
        let force = forces(body.points.len());
        body.multigrid(&Settings::default()).solve(&force, 1e-8, 500, &mut unwatched).unwrap().iterations
    };
    let counts = [20, 60, 180].map(count);
    assert!(counts.iter().all(|count| *count <= 20), "{counts:?}");
}

/// The V-cycle is symmetric and positive: else conjugate gradients would be none. Its spectrum ends at 1.
#[test]
fn the_preconditioner_is_symmetric_and_not_stiffer_than_the_matrix() {
    let body = Body::<3>::new([9, 8, 7], [1.0, 0.5, 2.0], Shape::Cube, 0.5, 0.3);
    let levels = body.multigrid(&Settings { dense: 60, ..Settings::default() });
    let mut room = levels.workspace();
    let n = body.points.len();
    let mut random = random(9);
    let mut vector = || -> Vec<[f64; 3]> {
        let free = |i: usize, x: f64| if body.is_held[i] { 0.0 } else { x };
        (0..n / 3).map(|p| std::array::from_fn(|k| free(3 * p + k, random()))).collect()
    };
    let product = |x: &[[f64; 3]], y: &[[f64; 3]]| -> f64 {
        x.iter().flatten().zip(y.iter().flatten()).map(|(x, y)| x * y).sum()
    };
    for _ in 0..10 {
        let (x, y) = (vector(), vector());
        let (mut mx, mut my) = (x.clone(), x.clone());
        levels.apply(&x, &mut mx, &mut room);
        levels.apply(&y, &mut my, &mut room);
        assert!((product(&mx, &y) - product(&x, &my)).abs() < 1e-12 * product(&x, &mx));
        // xᵀ A x ≥ xᵀ A M⁻¹ A x.
        let mut ax = x.clone();
        levels.matrix().apply(&x, &mut ax);
        levels.apply(&ax, &mut mx, &mut room);
        assert!(product(&ax, &mx) <= product(&ax, &x) * (1.0 + 1e-10));
    }
}

/// Sums are taken in one order.
#[test]
fn a_solution_has_the_same_bits_on_any_number_of_threads() {
    let body = Body::<3>::new([26, 22, 24], [1.0; 3], Shape::Cube, 0.4, 0.3);
    let force = forces(body.points.len());
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| body.multigrid(&Settings::default()).solve(&force, 1e-8, 500, &mut unwatched).unwrap())
    };
    assert_eq!(on(1), on(3));
}

/// Two boxes that share no cell, one of them held at its own side.
#[test]
fn pieces_that_do_not_touch_are_solved_for_together() {
    let one = Body::<2>::new([12, 9], [1.0; 2], Shape::Simplex, 0.4, 0.3);
    let count = one.points.len() / 2;
    let mut both = Body::<2>::new([12, 9], [1.0; 2], Shape::Simplex, 0.4, 0.3);
    both.points.extend(one.points.chunks_exact(2).flat_map(|x| [x[0] + 40.0, x[1]]));
    both.nodes.extend(one.nodes.iter().map(|n| n + count as u32));
    both.starts.extend(one.starts[1..].iter().map(|s| s + one.nodes.len()));
    both.young.extend(one.young.iter().map(|_| 1e-3));
    both.is_held.extend(&one.is_held);
    let force = forces(both.points.len());
    let found = both.multigrid(&Settings { dense: 20, ..Settings::default() });
    let found = found.solve(&force, 1e-11, 500, &mut unwatched).unwrap();
    assert!(difference(&found.displacement, &exact(&both, &force)) < 1e-8);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn solutions_are_exact_whatever_the_moduli_sizes_and_supports(
        cells in [2usize..9, 2usize..9], stretch in 0.1f64..10.0, jitter in 0.0f64..0.7, poisson in 0.0f64..0.45,
        contrast in 0.0f64..4.0, seed in 1u64..1000, dense in 4usize..60,
    ) {
        let mut body = Body::<2>::new(cells, [1.0, stretch], Shape::Simplex, jitter, poisson);
        let mut random = random(seed);
        body.young.iter_mut().for_each(|e| *e = 10f64.powf(contrast * random()));
        let free: Vec<usize> = (0..body.is_held.len()).filter(|i| !body.is_held[*i]).collect();
        for i in free {
            body.is_held[i] = random() > 0.45;
        }
        let force: Vec<f64> = (0..body.points.len()).map(|_| random()).collect();
        let levels = body.multigrid(&Settings { dense, ..Settings::default() });
        let found = levels.solve(&force, 1e-12, 2000, &mut unwatched).unwrap();
        prop_assert!(difference(&found.displacement, &exact(&body, &force)) < 1e-8);
    }
}

#[test]
fn the_watch_hears_of_each_level_and_iteration_and_ends_the_work() {
    let body = Body::<3>::new([10; 3], [1.0; 3], Shape::Cube, 0.4, 0.3);
    let motions = space_motions(&body.points, &body.is_held);
    let mut heard = Vec::new();
    let mut hear = |event| {
        heard.push(event);
        ControlFlow::Continue(())
    };
    let levels = Multigrid::new(body.matrix(), &motions, &body.is_held, &Settings::default(), &mut hear).unwrap();
    let solution = levels.solve(&forces(body.points.len()), 1e-8, 500, &mut hear).unwrap();
    let told: Vec<_> =
        heard.iter().filter_map(|e| if let Event::Level(size) = e { Some(*size) } else { None }).collect();
    assert_eq!(told, levels.levels());
    assert_eq!(heard.len(), told.len() + solution.iterations);
    let mut end = |event| {
        if matches!(event, Event::Iteration { number: 3, .. }) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    assert_eq!(levels.solve(&forces(body.points.len()), 1e-8, 500, &mut end), Err(Fault::Interrupted));
    let mut at_once = |_| ControlFlow::Break(());
    let built = Multigrid::new(body.matrix(), &motions, &body.is_held, &Settings::default(), &mut at_once);
    assert_eq!(built.err(), Some(Fault::Interrupted));
}

#[test]
fn what_does_not_fit_or_is_not_finite_is_refused() {
    let body = Body::<2>::new([5, 5], [1.0; 2], Shape::Cube, 0.4, 0.3);
    let motions = plane_motions(&body.points, &body.is_held);
    let new = |motions: &[_], held: &[bool]| {
        Multigrid::<2, 3>::new(body.matrix(), motions, held, &Settings::default(), &mut unwatched).err()
    };
    assert!(matches!(new(&motions[1..], &body.is_held), Some(Fault::Size { expected: 36, found: 35, .. })));
    assert!(matches!(new(&motions, &[true]), Some(Fault::Size { expected: 72, found: 1, .. })));
    let levels = body.multigrid(&Settings::default());
    assert!(matches!(levels.solve(&[0.0], 1e-8, 10, &mut unwatched), Err(Fault::Size { expected: 72, found: 1, .. })));
    let mut force = vec![0.0; 72];
    assert_eq!(levels.solve(&force, 1e-8, 10, &mut unwatched).unwrap().displacement, force);
    force[9] = f64::NAN;
    assert_eq!(levels.solve(&force, 1e-8, 10, &mut unwatched), Err(Fault::NotFinite));
}

/// Too few iterations end in an error that says how far they came.
#[test]
fn a_stall_says_residual_and_levels() {
    let body = Body::<2>::new([40, 40], [1.0; 2], Shape::Cube, 0.4, 0.3);
    let fault =
        body.multigrid(&Settings::default()).solve(&forces(body.points.len()), 1e-10, 3, &mut unwatched).unwrap_err();
    let Fault::Stalled { residual, iterations, levels } = &fault else { panic!("{fault}") };
    assert!(*residual > 0.0 && *iterations == 3 && levels[0].nodes == 41 * 41);
    assert!(fault.to_string().contains("after 3 iterations (levels: 1681 × 2, "), "{fault}");
}
