//! Steps per second of a membrane of length springs on one core: a dome of 558 points, 1050 triangles and 1607 springs, fixed at
//! its rim and poked in the middle, and ones of more springs: larger membranes of the same cells, where `h² k/m` of a spring stays, and
//! the same membrane refined, where it grows as the number of springs. `cargo bench --bench dynamics`.

mod clock;

use clock::clock;
use springfit_bodies::dynamics::{Curve, Drive, Integrator, LinearSolver, Motion, Options, Simulation, StepOutcome};
use springfit_bodies::model::{Network, Support, masses};
use springfit_element::element::Element;
use springfit_element::material::{Material, State};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight, fit_cells};
use springfit_mesh::mesh::{DiscMesh, Mesh};
use std::sync::Arc;

const THICKNESS: f64 = 5e-4;

/// A membrane of 10 kPa and 1000 kg/m³, a fifth as high as its radius, m.
fn membrane(rings: Vec<usize>, radius: f64) -> (Mesh, Network) {
    let element = Arc::new(Element::load("tri3").expect("it is shipped"));
    let mesh = DiscMesh { element, radius, height: radius / 5.0, rings }.build().expect("the rings are sound");
    let block = &mesh.blocks[0];
    let springs = Springs::select(&block.element, None).expect("no group is named");
    let state = State::PlaneStress { thickness: THICKNESS };
    let moduli = Material::new(10e3, 0.3, state).expect("it is valid").moduli();
    let fit = Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(Weight::OffDiagonal)) };
    let fits = fit_cells(&block.element, &springs, &mesh.points, &block.connectivity, moduli, &fit, &mut |_| {});
    let network = Network::assemble(&mesh, &[fits.expect("every cell has an area")]);
    (mesh, network)
}

/// Of every motion, from rest on: steps at another time may have other shapes to solve for.
const STEPS: usize = 24;
/// Of a motion of 25 s, in which the membrane folds.
const LONG: usize = 2500;

/// The median over three runs of the seconds per step, and the iterations of conjugate gradients per step. A run has `times` motions, and a
/// motion has `steps` steps.
fn seconds(mesh: &Mesh, network: &Network, options: Options, times: usize, steps: usize) -> (f64, f64) {
    let masses = masses(mesh, 1000.0, THICKNESS);
    let mut support = Support::free(mesh);
    support.fix(&mesh.groups["rim"].points, &[0, 1, 2], 3);
    support.fix(&mesh.groups["middle"].points, &[0, 1, 2], 3);
    let poke = Curve::new(|t| -5e-4 * (1.0 - (6.0 * t).cos()));
    let drive = Drive::default().displacement(3 * mesh.groups["middle"].points[0] + 2, poke);
    let motion = Motion { support, drive, ..Motion::free(network, &mesh.points, &masses) };
    let mut simulation = Simulation::new(motion, options).expect("the model is sound");
    let zero = vec![0.0; mesh.points.len()];
    let mut iterations = 0;
    let mut runs: Vec<f64> = (0..3)
        .map(|_| {
            let start = clock();
            for _ in 0..times {
                simulation.start(&zero, &zero).expect("it rests");
                for _ in 0..steps {
                    let step = simulation.step();
                    assert_ne!(step.outcome, StepOutcome::Stalled, "a step was not solved");
                    iterations += step.solver_iterations;
                }
            }
            (clock() - start) / (times * steps) as f64
        })
        .collect();
    runs.sort_by(f64::total_cmp);
    assert!(simulation.state().displacement.iter().all(|u| u.abs() < 1e-2), "the membrane ran away");
    (runs[1], iterations as f64 / (3 * times * steps) as f64)
}

fn main() {
    let real_time = Options { iterations: 1, account: false, ..Options::default() };
    let gradients = |tolerance| Options { solver: LinearSolver::ConjugateGradients { tolerance }, ..real_time };
    let methods = [
        ("linear, one factor", Options { linear: true, ..real_time }),
        ("linear, CG to 1e-6", Options { linear: true, ..gradients(1e-6) }),
        ("linearised, a factor each step", real_time),
        ("linearised, CG to 1e-6", gradients(1e-6)),
        ("linearised, CG to 1e-3", gradients(1e-3)),
        ("explicit, 10 us", Options { integrator: Integrator::SymplecticEuler, step: 1e-5, ..real_time }),
    ];
    let sizes = [
        ("as it is", DiscMesh::rings_of(558, 15, 64), 1.0, 40, STEPS),
        ("folded", DiscMesh::rings_of(558, 15, 64), 1.0, 1, LONG),
        ("larger", DiscMesh::even(33), 33.0 / 13.5, 4, STEPS),
        ("larger", DiscMesh::even(105), 105.0 / 13.5, 1, STEPS),
        ("refined", DiscMesh::even(33), 1.0, 4, STEPS),
        ("refined", DiscMesh::even(105), 1.0, 1, STEPS),
    ];
    println!(
        "{:9} {:>8} {:>8}  {:32} {:>12} {:>9} {:>10} {:>8}",
        "membrane", "points", "springs", "method", "us/step", "steps/s", "ns/spring", "CG/step"
    );
    for (kind, rings, scale, times, steps) in sizes {
        let (mesh, network) = membrane(rings, 5e-3 * scale);
        // A linear model does not fold.
        for (name, options) in methods.into_iter().filter(|(_, options)| steps == STEPS || !options.linear) {
            let (each, iterations) = seconds(&mesh, &network, options, times, steps);
            let (points, springs) = (mesh.point_count(), network.len());
            let (micro, nano, rate) = (1e6 * each, 1e9 * each / springs as f64, 1.0 / each);
            println!("{kind:9} {points:8} {springs:8}  {name:32} {micro:12.1} {rate:9.0} {nano:10.1} {iterations:8.1}");
        }
    }
}
