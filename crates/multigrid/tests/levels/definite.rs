//! Whether a matrix is positive definite: found, or shown by a motion.

use super::elastic::{Body, Shape, random};
use springfit_multigrid::{
    BlockMatrix, Definiteness, End, Fault, Motion, Multigrid, Settings, space_motions, unwatched,
};
use std::sync::Arc;

/// `xᵀ A x` of a motion, worked out here.
fn energy(a: &BlockMatrix<3, 3>, motion: &Motion, is_held: &[bool]) -> f64 {
    assert!(is_held.iter().zip(&motion.displacement).all(|(held, x)| !held || *x == 0.0));
    let x = motion.displacement.as_chunks::<3>().0;
    let mut force = vec![[0.0; 3]; x.len()];
    a.apply(x, &mut force);
    x.iter().flatten().zip(force.iter().flatten()).map(|(x, f)| x * f).sum()
}

/// `A − shift I`.
fn shifted(a: &BlockMatrix<3, 3>, shift: f64) -> Arc<BlockMatrix<3, 3>> {
    let mut a = a.clone();
    for row in 0..a.rows() {
        let at = a.pattern().place(row, row).unwrap();
        (0..3).for_each(|k| a.values_mut()[at][k][k] -= shift);
    }
    Arc::new(a)
}

fn levels(body: &Body<3>, a: Arc<BlockMatrix<3, 3>>) -> Result<Multigrid<3, 6>, Fault> {
    let motions = space_motions(&body.points, &body.is_held);
    Multigrid::new(a, &motions, &body.is_held, &Settings { dense: 200, ..Settings::default() }, &mut unwatched)
}

/// The least eigenvalue, by the inverse iteration that a solution is.
fn least(body: &Body<3>) -> f64 {
    let levels = body.multigrid(&Settings::default());
    let mut random = random(2);
    let mut x: Vec<f64> = (0..body.points.len()).map(|_| random()).collect();
    let mut value = 0.0;
    for _ in 0..30 {
        let size = x.iter().map(|x| x * x).sum::<f64>().sqrt();
        x.iter_mut().for_each(|x| *x /= size);
        let next = levels.solve(&x, 1e-10, 500, &mut unwatched).unwrap().displacement;
        value = 1.0 / x.iter().zip(&next).map(|(x, y)| x * y).sum::<f64>();
        x = next;
    }
    value
}

/// A shift by more than the least eigenvalue, however little, makes the matrix indefinite. It is never called positive; below, always.
#[test]
fn a_shift_past_the_least_eigenvalue_is_seen_and_shown() {
    for shape in [Shape::Cube, Shape::Simplex] {
        let body = Body::<3>::new([14, 8, 8], [1.0; 3], shape, 0.4, 0.3);
        let (a, least) = (body.matrix(), least(&body));
        for factor in [0.0, 0.5, 0.9] {
            let found =
                levels(&body, shifted(&a, factor * least)).unwrap().definiteness(1e-12, 300, &mut unwatched).unwrap();
            let Definiteness::Positive { doubt, iterations } = found else { panic!("{factor}: {found:?}") };
            assert!(doubt <= 1e-12 && iterations <= 160, "{factor}: {iterations}");
        }
        for factor in [1.001, 1.1, 2.0, 10.0, 1000.0] {
            let a = shifted(&a, factor * least);
            let motion = match levels(&body, a.clone()) {
                Err(Fault::NotPositive(motion)) => motion,
                Err(other) => panic!("{other}"),
                Ok(levels) => match levels.definiteness(1e-12, 300, &mut unwatched).unwrap() {
                    Definiteness::NotPositive { motion, .. } => motion,
                    other => panic!("{factor}: {other:?}"),
                },
            };
            assert!(energy(&a, &motion, &body.is_held) < 0.0, "{factor}");
            assert!(motion.energy < 0.0);
        }
    }
}

/// One spring that pushes, hidden in a large body: its motion is local.
#[test]
fn one_indefinite_cell_of_many_is_seen() {
    let mut body = Body::<3>::new([16; 3], [1.0; 3], Shape::Simplex, 0.4, 0.3);
    body.young[12_345] = -8.0;
    let a = body.matrix();
    let motion = match levels(&body, a.clone()) {
        Err(Fault::NotPositive(motion)) => motion,
        Err(other) => panic!("{other}"),
        Ok(levels) => match levels.definiteness(1e-12, 300, &mut unwatched).unwrap() {
            Definiteness::NotPositive { motion, .. } => motion,
            other => panic!("{other:?}"),
        },
    };
    assert!(energy(&a, &motion, &body.is_held) < 0.0);
}

/// A body without supports has six motions without energy; rounding decides on their sign, and "positive" is not said.
#[test]
fn a_body_without_supports_is_not_called_positive() {
    let mut body = Body::<3>::new([9, 8, 7], [1.0; 3], Shape::Cube, 0.4, 0.3);
    body.is_held.fill(false);
    match levels(&body, body.matrix()) {
        Err(Fault::NotPositive(_)) => {}
        Err(other) => panic!("{other}"),
        Ok(levels) => {
            let found = levels.definiteness(1e-12, 300, &mut unwatched).unwrap();
            assert!(!matches!(found, Definiteness::Positive { .. }), "{found:?}");
        }
    }
}

/// A node that nothing holds is a motion of its own.
#[test]
fn a_loose_node_is_shown() {
    let mut body = Body::<3>::new([3; 3], [1.0; 3], Shape::Cube, 0.4, 0.3);
    body.points.extend([9.0, 9.0, 9.0]);
    body.is_held.extend([false; 3]);
    let Err(Fault::NotPositive(motion)) = levels(&body, body.matrix()) else { panic!() };
    let loose = motion.displacement.len() - 3;
    assert!(motion.displacement[..loose].iter().all(|x| *x == 0.0));
}

/// Of `A x = λ B x` with B of another modulus in a part of the body: against the ratio of the moduli where it is known.
#[test]
fn the_softest_motion_has_the_least_quotient() {
    let body = Body::<3>::new([12, 6, 6], [1.0; 3], Shape::Cube, 0.4, 0.3);
    let mut soft = Body::<3>::new([12, 6, 6], [1.0; 3], Shape::Cube, 0.4, 0.3);
    soft.young.iter_mut().for_each(|e| *e = 0.25);
    let (a, b) = (soft.matrix(), body.matrix());
    let found = soft.multigrid(&Settings::default()).extreme(End::Least, &a, &b, None, 60, &mut unwatched).unwrap();
    assert!((found.quotient - 0.25).abs() < 1e-12 && found.is_settled);
    // One soft layer: the quotient is between the moduli, at the softer one for a motion of that layer alone.
    soft.young.iter_mut().enumerate().for_each(|(cell, e)| *e = if (6..9).contains(&(cell % 12)) { 0.01 } else { 1.0 });
    let a = soft.matrix();
    let found = soft.multigrid(&Settings::default()).extreme(End::Least, &a, &b, None, 60, &mut unwatched).unwrap();
    assert!(found.quotient >= 0.01 - 1e-9 && found.quotient < 0.0105, "{found:?}");
    assert!(found.iterations < 40);
}

/// Proof and softest motion together cost less than two solutions to ten digits.
#[test]
fn the_proof_is_not_dearer_than_two_solutions() {
    let body = Body::<3>::new([20; 3], [1.0; 3], Shape::Cube, 0.4, 0.3);
    let levels = body.multigrid(&Settings::default());
    let force: Vec<f64> = body.is_held.iter().map(|held| if *held { 0.0 } else { 1.0 }).collect();
    let solution = levels.solve(&force, 1e-10, 500, &mut unwatched).unwrap();
    let Definiteness::Positive { iterations, .. } = levels.definiteness(1e-12, 300, &mut unwatched).unwrap() else {
        panic!()
    };
    assert!(iterations <= 2 * solution.iterations + 4, "{iterations} and {}", solution.iterations);
}
