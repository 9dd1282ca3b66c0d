//! Several right hand sides that are solved side by side.

use super::elastic::{Body, Shape, random};
use proptest::prelude::*;
use springfit_multigrid::{BlockMatrix, Event, Fault, Multigrid, Settings, Solution, space_motions, unwatched};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Forces of very different sizes, smooth and rough, the first of them zero.
fn forces(body: &Body<3>, count: usize) -> Vec<Vec<f64>> {
    let mut random = random(7);
    let size = body.points.len();
    let one = |i: usize| {
        let scale = if i == 0 { 0.0 } else { 10_f64.powi((7 * i % 24) as i32 - 12) };
        if i.is_multiple_of(2) { vec![scale; size] } else { (0..size).map(|_| scale * random()).collect() }
    };
    (0..count).map(one).collect()
}

fn each(levels: &Multigrid<3, 6>, forces: &[Vec<f64>], tolerance: f64) -> Result<Vec<Solution>, Fault> {
    let forces: Vec<&[f64]> = forces.iter().map(|force| &force[..]).collect();
    levels.solve_each(&forces, tolerance, 500, &mut unwatched)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Each search is that of the right hand side alone up to rounding, which the tolerance of 1e-12 leaves at some 1e-10 of the whole.
    #[test]
    fn solutions_side_by_side_are_those_of_each_alone(
        count in 0_usize..20,
        [l, m, n] in [3_usize..9, 3_usize..9, 3_usize..9],
        dense in 30_usize..300,
        poisson in 0.0..0.45,
    ) {
        let body = Body::<3>::new([l, m, n], [1.0; 3], Shape::Simplex, 0.4, poisson);
        let levels = body.multigrid(&Settings { dense, ..Settings::default() });
        let forces = forces(&body, count);
        let found = each(&levels, &forces, 1e-12).unwrap();
        prop_assert_eq!(found.len(), count);
        for (force, found) in forces.iter().zip(&found) {
            let alone = levels.solve(force, 1e-12, 500, &mut unwatched).unwrap();
            let largest = alone.displacement.iter().fold(0.0_f64, |largest, u| largest.max(u.abs()));
            for (u, expected) in found.displacement.iter().zip(&alone.displacement) {
                prop_assert!((u - expected).abs() <= 1e-9 * largest, "{u} and {expected} of {largest}");
            }
            prop_assert!(found.iterations.abs_diff(alone.iterations) <= 1);
            prop_assert!(found.residual < 1e-9 && found.error <= 1e-12);
        }
    }
}

#[test]
fn solutions_side_by_side_have_the_same_bits_on_any_number_of_threads() {
    let body = Body::<3>::new([30, 12, 12], [1.0; 3], Shape::Cube, 0.4, 0.3);
    let forces = forces(&body, 11);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| each(&body.multigrid(&Settings::default()), &forces, 1e-8).unwrap())
    };
    assert_eq!(on(1), on(3));
}

/// A spring that pushes is met by the search of the force on it, whichever lane that is in.
#[test]
fn a_motion_without_energy_ends_all_of_them() {
    let body = Body::<3>::new([6; 3], [1.0; 3], Shape::Cube, 0.4, 0.3);
    let mut matrix: BlockMatrix<3, 3> = (*body.matrix()).clone();
    // Every diagonal block alone stays positive definite.
    for row in 0..matrix.rows() {
        let at = matrix.pattern().place(row, row).unwrap();
        matrix.values_mut()[at].iter_mut().flatten().for_each(|k| *k *= 0.6);
    }
    let motions = space_motions(&body.points, &body.is_held);
    let settings = Settings::default();
    let motion = match Multigrid::new(Arc::new(matrix.clone()), &motions, &body.is_held, &settings, &mut unwatched) {
        Err(Fault::NotPositive(motion)) => motion,
        Err(other) => panic!("{other}"),
        Ok(levels) => match each(&levels, &forces(&body, 5), 1e-10) {
            Err(Fault::NotPositive(motion)) => motion,
            other => panic!("{other:?}"),
        },
    };
    let x = motion.displacement.as_chunks::<3>().0;
    let mut image = vec![[0.0; 3]; x.len()];
    matrix.apply(x, &mut image);
    assert!(x.iter().flatten().zip(image.iter().flatten()).map(|(x, f)| x * f).sum::<f64>() < 0.0);
}

#[test]
fn faults_of_one_right_hand_side_are_those_of_all() {
    let body = Body::<3>::new([8; 3], [1.0; 3], Shape::Cube, 0.4, 0.3);
    let levels = body.multigrid(&Settings::default());
    let mut all = forces(&body, 9);
    let size = all[0].len();
    let given = |all: &[Vec<f64>], iterations: usize| {
        let all: Vec<&[f64]> = all.iter().map(|force| &force[..]).collect();
        let mut heard = Vec::new();
        let mut hear = |event| {
            heard.push(event);
            ControlFlow::Continue(())
        };
        let found = levels.solve_each(&all, 1e-10, iterations, &mut hear);
        (found, heard)
    };
    let (found, heard) = given(&all, 3);
    assert!(matches!(found, Err(Fault::Stalled { iterations: 3, .. })), "{found:?}");
    assert!(matches!(heard[..], [Event::Iteration { number: 1, .. }, _, Event::Iteration { number: 3, .. }]));
    all[8][4] = f64::INFINITY;
    assert_eq!(given(&all, 500), (Err(Fault::NotFinite), Vec::new()));
    all[5].pop();
    assert!(
        matches!(given(&all, 500).0, Err(Fault::Size { expected, found, .. }) if expected == size && found == size - 1)
    );
    let end = &mut |_| ControlFlow::Break(());
    let [a, b, c] = [&all[1][..], &all[2], &all[3]];
    assert_eq!(levels.solve_each(&[a, b, c], 1e-10, 500, end), Err(Fault::Interrupted));
}
