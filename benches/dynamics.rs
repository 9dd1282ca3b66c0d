//! Steps per second of a membrane of length springs on one core: a dome of 558 points, 1050 triangles and 1607 springs, fixed at
//! its rim and poked in the middle, and larger ones. `cargo bench --bench dynamics`.

use springfit::dynamics::{Curve, Drive, Integrator, Motion, Options, Simulation};
use springfit::element::Element;
use springfit::fit::{Fit, Objective, Weight, fit_cells};
use springfit::material::{Material, State};
use springfit::mesh::{DiscMesh, Mesh};
use springfit::model::{Network, Support, masses};
use springfit::springs::Springs;
use std::sync::Arc;
use std::time::Instant;

const THICKNESS: f64 = 5e-4;

/// A membrane of 5 mm, 10 kPa and 1000 kg/m³.
fn membrane(rings: Vec<usize>) -> (Mesh, Network) {
    let element = Arc::new(Element::load("tri3").expect("it is shipped"));
    let mesh = DiscMesh { element, radius: 5e-3, height: 1e-3, rings }.build().expect("the rings are sound");
    let block = &mesh.blocks[0];
    let springs = Springs::select(&block.element, None).expect("no group is named");
    let state = State::PlaneStress { thickness: THICKNESS };
    let moduli = Material::new(10e3, 0.3, state).expect("it is valid").moduli();
    let fit = Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(Weight::OffDiagonal)) };
    let fits = fit_cells(&block.element, &springs, &mesh.points, &block.connectivity, moduli, &fit, &mut |_| {});
    let network = Network::assemble(&mesh, &[fits.expect("every cell has an area")]);
    (mesh, network)
}

/// Seconds per step, the median of five runs.
fn seconds(mesh: &Mesh, network: &Network, options: Options, steps: usize) -> f64 {
    let masses = masses(mesh, 1000.0, THICKNESS);
    let mut support = Support::free(mesh);
    support.fix(&mesh.groups["rim"].points, &[0, 1, 2], 3);
    support.fix(&mesh.groups["middle"].points, &[0, 1, 2], 3);
    let poke = Curve::new(|t| -5e-4 * (1.0 - (6.0 * t).cos()));
    let drive = Drive::default().displacement(3 * mesh.groups["middle"].points[0] + 2, poke);
    let motion = Motion { support, drive, ..Motion::free(network, &mesh.points, &masses) };
    let mut simulation = Simulation::new(motion, options).expect("the model is sound");
    simulation.step();
    let mut runs: Vec<f64> = (0..5)
        .map(|_| {
            let start = Instant::now();
            (0..steps).for_each(|_| {
                simulation.step();
            });
            start.elapsed().as_secs_f64() / steps as f64
        })
        .collect();
    runs.sort_by(f64::total_cmp);
    assert!(simulation.state().displacement.iter().all(|u| u.abs() < 1e-2), "the membrane ran away");
    runs[2]
}

fn main() {
    let real_time = Options { iterations: 1, account: false, ..Options::default() };
    let methods = [
        ("linear, one factor", Options { linear: true, ..real_time }),
        ("linearised, a factor each step", real_time),
        ("explicit, 10 us", Options { integrator: Integrator::SymplecticEuler, step: 1e-5, ..real_time }),
    ];
    println!(
        "{:>8} {:>9} {:>8}  {:32} {:>12} {:>12} {:>10}",
        "points", "triangles", "springs", "method", "us/step", "steps/s", "ns/spring"
    );
    for (rings, steps) in [(DiscMesh::rings_of(558, 15, 64), 1000), (DiscMesh::even(33), 100), (DiscMesh::even(105), 8)]
    {
        let (mesh, network) = membrane(rings);
        for (name, options) in methods {
            let each = seconds(&mesh, &network, options, steps);
            let (points, cells, springs) = (mesh.point_count(), mesh.cell_count(), network.len());
            let (micro, nano) = (1e6 * each, 1e9 * each / springs as f64);
            println!("{points:8} {cells:9} {springs:8}  {name:32} {micro:12.1} {:12.0} {nano:10.1}", 1.0 / each);
        }
    }
}
