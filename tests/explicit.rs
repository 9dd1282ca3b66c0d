//! Explicit motions of networks: K at rest in blocks is that of its entries, a state in rows moves as one in lists, and large bodies move
//! alike on any number of threads.

use crate::dynamics::{cube, scattered};
use crate::shapes::statics::{dense, support_at};
use springfit_bodies::dynamics::{
    Curve, Damping, Drive, Integrator, Motion, MotionState, Options, Simulation, StepOutcome,
};
use springfit_bodies::model::{
    BlockStiffness, Elastic, LengthSpring, Lumping, Network, Precision, Response, Support, lumped_masses,
};

/// A network whose stiffness is known by its entries alone.
struct Listed<'a>(&'a Network);

impl Elastic for Listed<'_> {
    fn respond(&self, x: &[f64]) -> Option<Response> {
        self.0.respond(x)
    }
}

fn explicit(step: f64) -> Options {
    Options { step, integrator: Integrator::SymplecticEuler, ..Options::default() }
}

/// With a face held and damping in proportion to the stiffness, springs that rotate and springs that do not. Both ways add the same
/// numbers in another order, 1e-16 of each, for 50 steps.
#[test]
fn blocks_move_a_network_as_its_entries_do() {
    for (element, side) in [("tet4", 3), ("hex8", 3)] {
        let (mesh, mut network) = cube(element, side);
        network.lengths.push(LengthSpring { points: [0, mesh.point_count() - 1], constant: 3.0, rest: 0.0 });
        let masses = lumped_masses(&mesh, 1000.0, 1.0, Lumping::Hrz);
        let mut support = Support { prescribed: vec![None; mesh.points.len()] };
        (0..mesh.points.len())
            .filter(|dof| mesh.points[dof - dof % 3] == 0.0)
            .for_each(|dof| support.prescribed[dof] = Some(0.0));
        let damping = Damping { mass: 0.1, stiffness: 1e-4, dampers: None };
        let listed = Listed(&network);
        for linear in [false, true] {
            let moved = |model: &dyn Elastic| {
                let motion = Motion {
                    support: support.clone(),
                    damping: damping.clone(),
                    ..Motion::free(model, &mesh.points, &masses)
                };
                let longest =
                    Simulation::new(motion.clone(), Options { linear, ..explicit(1e-9) }).unwrap().longest_step();
                let mut simulation = Simulation::new(motion, Options { linear, ..explicit(0.5 * longest) }).unwrap();
                simulation.start(&vec![0.0; mesh.points.len()], &scattered(mesh.points.len(), 1e-2)).unwrap();
                (0..50).for_each(|_| assert_eq!(simulation.step().outcome, StepOutcome::Converged));
                (longest, simulation.state().clone())
            };
            let ((longest, blocks), (other, entries)) = (moved(&network), moved(&listed));
            assert!((longest / other - 1.0).abs() < 1e-12, "{element}: {longest:e} s and {other:e} s");
            let size = entries.displacement.iter().fold(0.0f64, |size, u| size.max(u.abs()));
            let apart = blocks.displacement.iter().zip(&entries.displacement).map(|(a, b)| (a - b).abs());
            assert!(size > 0.0 && apart.fold(0.0, f64::max) < 1e-11 * size, "{element}, linear {linear}");
        }
    }
}

/// The largest difference of two lists as a share of the largest number.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let size = a.iter().fold(0.0f64, |size, x| size.max(x.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size
}

/// Held at one face, pulled at a point, under gravity and a force that changes; with the account the state is in lists, without it in rows
/// of the network's numbers.
fn driven<N: Precision>(element: &str, steps: usize, account: bool) -> MotionState {
    let (mesh, mut network) = cube(element, 3);
    network.lengths.push(LengthSpring { points: [0, mesh.point_count() - 1], constant: 3.0, rest: 0.0 });
    let masses = lumped_masses(&mesh, 1000.0, 1.0, Lumping::Hrz);
    let d = mesh.dimension;
    let mut support = Support::free(&mesh);
    let held: Vec<usize> = (0..mesh.point_count()).filter(|p| mesh.points[p * d] == 0.0).collect();
    support.fix(&held, &[0], d);
    let last = mesh.points.len() - 1;
    let drive = Drive::default()
        .gravity(&vec![-9.81; d])
        .displacement(last, Curve::new(|t| 1e-3 * (1.0 - (50.0 * t).cos())))
        .force(last - d, Curve::new(|t| 0.01 * t));
    let prepared = network.prepared_in::<N>();
    let motion = Motion { support, drive, ..Motion::free(&*prepared, &mesh.points, &masses) };
    let longest = Simulation::new(motion.clone(), explicit(1e-9)).unwrap().longest_step();
    let mut simulation = Simulation::new(motion, Options { account, ..explicit(0.5 * longest) }).unwrap();
    simulation.start(&vec![0.0; mesh.points.len()], &scattered(mesh.points.len(), 1e-2)).unwrap();
    (0..steps).for_each(|_| assert_eq!(simulation.step().outcome, StepOutcome::Converged));
    simulation.state().clone()
}

#[test]
fn a_state_in_rows_has_the_bits_of_one_in_lists() {
    for element in ["tri3", "quad4", "tet4", "hex8"] {
        assert_eq!(driven::<f64>(element, 60, false), driven::<f64>(element, 60, true), "{element}");
    }
}

/// Forces are rounded to 6e-8 of what springs would pull if they measured from zero, 3 cm of which the points move about 1 mm: 2e-6
/// of the forces that move them. Errors of 200 steps add up like a random walk, √200 times as large, which is 3e-5 of the velocities;
/// displacements sum them up and lose the signs.
#[test]
fn single_precision_follows_double_precision() {
    for element in ["tri3", "quad4", "tet4", "hex8"] {
        let double = driven::<f64>(element, 200, false);
        for account in [false, true] {
            let single = driven::<f32>(element, 200, account);
            let [u, v] = [apart(&double.displacement, &single.displacement), apart(&double.velocity, &single.velocity)];
            assert!(u > 0.0 && u < 2e-5 && v < 1e-4, "{element}, account {account}: {u:e}, {v:e}");
        }
    }
}

/// A body a thousand times as far from the origin as it is long moves as it does at the origin. Its positions in double precision are rounded to
/// 1e-13 of its length; in single precision they are measured from one of its points.
#[test]
fn bodies_far_from_the_origin_move_alike() {
    for element in ["tet4", "hex8"] {
        let (mesh, network) = cube(element, 3);
        let masses = lumped_masses(&mesh, 1000.0, 1.0, Lumping::Hrz);
        let held: Vec<usize> = (0..mesh.point_count()).filter(|p| mesh.points[p * 3] == 0.0).collect();
        let support = support_at(&mesh, &held);
        let prepared = network.prepared_in::<f32>();
        for account in [false, true] {
            let moved = |far: f64| {
                let points: Vec<f64> = mesh.points.iter().map(|x| x + far).collect();
                let drive = Drive::default().gravity(&[-9.81; 3]);
                let motion = Motion { support: support.clone(), drive, ..Motion::free(&*prepared, &points, &masses) };
                let options = Options { account, ..explicit(1e-4) };
                let mut simulation = Simulation::new(motion, options).unwrap();
                (0..200).for_each(|_| assert_eq!(simulation.step().outcome, StepOutcome::Converged));
                simulation.state().displacement.clone()
            };
            let (near, far) = (moved(0.0), moved(1000.0 * mesh.points.iter().fold(0.0f64, |a, x| a.max(*x))));
            assert!(apart(&near, &far) < 1e-4, "{element}, account {account}: {:e}", apart(&near, &far));
        }
    }
}

/// Two points that meet: a spring of no length has no direction. The numbers are exact in both precisions.
#[test]
fn a_step_without_forces_leaves_the_state_before() {
    fn check<N: Precision>(account: bool) {
        let network = Network {
            dimension: 2,
            lengths: vec![LengthSpring { points: [0, 1], constant: 1.0, rest: 1.0 }],
            others: vec![],
        };
        let (points, masses, prepared) = ([0.0, 0.0, 1.0, 0.0], [1.0; 2], network.prepared_in::<N>());
        let options = Options { account, ..explicit(0.5) };
        let mut simulation = Simulation::new(Motion::free(&*prepared, &points, &masses), options).unwrap();
        simulation.start(&[0.0; 4], &[1.0, 0.0, -1.0, 0.0]).unwrap();
        let before = simulation.state().clone();
        assert_eq!(simulation.step().outcome, StepOutcome::NoResponse);
        assert_eq!(simulation.state(), &before);
        // It can start again, and move.
        simulation.start(&[0.0; 4], &[0.25, 0.0, -0.25, 0.0]).unwrap();
        assert_eq!(simulation.step().outcome, StepOutcome::Converged);
        assert_eq!(simulation.positions(), [0.125, 0.0, 0.875, 0.0]);
    }
    for account in [false, true] {
        check::<f64>(account);
        check::<f32>(account);
    }
}

/// 90 000 degrees of freedom, which passes share out to the threads; forces, motion and the account of energies.
#[test]
fn large_bodies_move_with_the_same_bits_on_any_number_of_threads() {
    let side = 30;
    let count = side * side * side;
    let place = |i: usize, j: usize, k: usize| (i * side + j) * side + k;
    let mut network = Network { dimension: 3, ..Network::default() };
    let mut points = Vec::new();
    for (i, j, k) in (0..count).map(|p| (p / side / side, p / side % side, p % side)) {
        points.extend([i, j, k].map(|x| x as f64));
        for (other, is_there) in
            [(place(i + 1, j, k), i + 1 < side), (place(i, j + 1, k), j + 1 < side), (place(i, j, k + 1), k + 1 < side)]
        {
            if is_there {
                network.lengths.push(LengthSpring { points: [place(i, j, k), other], constant: 1.0, rest: 1.0 });
            }
        }
    }
    assert!(points.len() > 65_536 && network.lengths.len() > 65_536);
    let masses = vec![1.0; count];
    let moved = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let prepared = network.prepared();
            let damping = Damping { mass: 0.1, stiffness: 0.01, dampers: None };
            let motion = Motion { damping, ..Motion::free(&prepared, &points, &masses) };
            let mut simulation = Simulation::new(motion, explicit(0.1)).unwrap();
            simulation.start(&vec![0.0; points.len()], &scattered(points.len(), 0.3)).unwrap();
            (0..5).for_each(|_| assert_eq!(simulation.step().outcome, StepOutcome::Converged));
            (simulation.longest_step(), simulation.state().clone(), simulation.account())
        })
    };
    let in_rows = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let prepared = network.prepared();
            let options = Options { account: false, ..explicit(0.1) };
            let mut simulation = Simulation::new(Motion::free(&prepared, &points, &masses), options).unwrap();
            simulation.start(&vec![0.0; points.len()], &scattered(points.len(), 0.3)).unwrap();
            (0..5).for_each(|_| assert_eq!(simulation.step().outcome, StepOutcome::Converged));
            simulation.state().clone()
        })
    };
    let first = in_rows(1);
    assert!([2, 3].map(in_rows).iter().all(|other| *other == first));
    let first = moved(1);
    let balance = first.2.balance.unwrap();
    assert!(balance.dissipated > 0.0 && balance.drift.abs() < 0.05, "{balance:?}");
    assert!([2, 3].map(moved).iter().all(|other| *other == first));
}

/// In blocks and as entries, K at rest has the same row sums of absolute values, by which the step is bounded.
#[test]
fn absolute_sums_are_those_of_the_entries() {
    let (mesh, network) = cube("tet4", 3);
    let n = mesh.points.len();
    let weights: Vec<f64> = scattered(n, 1.0).iter().map(|w| 1.0 + w.abs()).collect();
    let full = dense(n, &network.stiffness(&mesh.points));
    let sums = BlockStiffness::of_network(&network, &mesh.points, None).absolute_sums(&weights);
    for (row, sum) in full.as_slice().chunks_exact(n).zip(sums) {
        let expected: f64 = row.iter().zip(&weights).map(|(k, w)| k.abs() * w).sum();
        assert!((sum / expected - 1.0).abs() < 1e-13, "{sum} instead of {expected}");
    }
}
