//! A network in motion by `Simulation::step` and by a plain loop in C, `explicit.c`, that is compiled for this machine.

use crate::clock::clock;
use springfit_bodies::dynamics::{Integrator, Motion, Options, Simulation, StepOutcome};
use springfit_bodies::model::{LengthSpring, Network, Precision, masses};
use springfit_element::element::Element;
use springfit_element::material::{Material, State};
use springfit_element::springs::Measure;
use springfit_fit::fit::{ExactEnergy, ExactFit, fit_exact};
use springfit_mesh::mesh::{BoxMesh, Mesh};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

/// A body that is not at rest: its network, its points, moved from rest, and its masses.
pub struct Case {
    pub name: &'static str,
    pub network: Network,
    points: Vec<f64>,
    masses: Vec<f64>,
    step: f64,
}

pub fn exact(mesh: &Mesh, material: Material) -> Network {
    let block = &mesh.blocks[0];
    let fit = ExactFit { energy: ExactEnergy::StableNeoHookean, large: true, ..ExactFit::default() };
    let cells = fit_exact(&block.element, &mesh.points, &block.connectivity, material, &fit, &mut |_| {});
    Network::assemble(mesh, &[cells.expect("every cell has a volume")])
}

pub fn cube(name: &'static str, element: &str, cells: usize, network: impl Fn(&Mesh, Material) -> Network) -> Case {
    let element = Arc::new(Element::load(element).expect("it is shipped"));
    let spec = BoxMesh { element, size: vec![1.0; 3], cells: vec![cells; 3], origin: vec![0.0; 3] };
    let mesh = spec.build().expect("the cells fill a box");
    let material = Material::new(1e4, 0.3, State::Solid).expect("it is valid");
    case(name, network(&mesh, material), &mesh, 1.0, 1e-4)
}

pub fn case(name: &'static str, network: Network, mesh: &Mesh, thickness: f64, step: f64) -> Case {
    let size = mesh.points.iter().fold(0.0f64, |size, x| size.max(x.abs()));
    let points = mesh.points.iter().map(|x| 1.01 * x + 1e-3 * size * (20.0 * x / size).sin()).collect();
    Case { name, network, points, masses: masses(mesh, 1000.0, thickness), step }
}

/// The network as the C program reads it.
pub fn write(case: &Case, steps: usize, to: &Path) {
    let Case { network, points, masses, step, .. } = case;
    let (bars, edges): (Vec<&LengthSpring>, Vec<&LengthSpring>) = network.lengths.iter().partition(|s| s.rest != 0.0);
    let (mut tets, mut hexes, mut table) = (Vec::new(), Vec::new(), Vec::new());
    for spring in &network.others {
        let (scale, is_hex) = match &spring.measure {
            Measure::Content(element) => (1.0 / 6.0, element.nodes() == 8),
            Measure::PointContent(element, q) => {
                table.clone_from(&element.tabulation.gradients);
                (element.tabulation.point_weight(*q as usize), element.nodes() == 8)
            }
            other => panic!("the C program has no {other:?}"),
        };
        assert!(spring.law.is_none(), "the C program has no laws");
        let entry = (&spring.points, spring.constant * scale * scale, spring.constant * scale * spring.rest);
        if is_hex { hexes.push(entry) } else { tets.push(entry) }
    }
    // The eight points of a hexahedron follow each other.
    assert!(hexes.chunks(8).all(|cell| cell.len() == 8 && cell.iter().all(|entry| entry.0 == cell[0].0)));
    let mut data = Vec::new();
    let counts = [masses.len(), bars.len(), edges.len(), tets.len(), hexes.len() / 8, steps];
    let int = |data: &mut Vec<u8>, n: usize| data.extend((n as i32).to_ne_bytes());
    let real = |data: &mut Vec<u8>, x: f64| data.extend(x.to_ne_bytes());
    counts.iter().for_each(|n| int(&mut data, *n));
    real(&mut data, *step);
    points.iter().for_each(|x| real(&mut data, *x));
    masses.iter().for_each(|m| (0..3).for_each(|_| real(&mut data, 1.0 / m)));
    bars.iter().for_each(|s| s.points.iter().for_each(|p| int(&mut data, *p)));
    bars.iter().for_each(|s| real(&mut data, s.constant));
    bars.iter().for_each(|s| real(&mut data, s.rest));
    edges.iter().for_each(|s| s.points.iter().for_each(|p| int(&mut data, *p)));
    edges.iter().for_each(|s| real(&mut data, s.constant));
    for (cells, every) in [(&tets, 1), (&hexes, 8)] {
        cells.iter().step_by(every).for_each(|cell| cell.0.iter().for_each(|p| int(&mut data, *p)));
        cells.iter().for_each(|cell| real(&mut data, cell.1));
        cells.iter().for_each(|cell| real(&mut data, cell.2));
    }
    table.iter().filter(|_| !hexes.is_empty()).for_each(|g| real(&mut data, *g));
    std::fs::write(to, data).expect("the folder can be written");
}

/// Seconds per step of the simulation with forces in these numbers, and where the points are at the end.
pub fn springfit<N: Precision>(case: &Case, steps: usize, account: bool) -> ([f64; 2], Vec<f64>) {
    let prepared = case.network.prepared_in::<N>();
    let motion = Motion::free(&*prepared, &case.points, &case.masses);
    let options = Options { step: case.step, integrator: Integrator::SymplecticEuler, account, ..Options::default() };
    let mut simulation = Simulation::new(motion, options).expect("the model is sound");
    let (from, start) = (clock(), Instant::now());
    (0..steps).for_each(|_| assert_ne!(simulation.step().outcome, StepOutcome::NoResponse));
    let seconds = [clock() - from, start.elapsed().as_secs_f64()];
    (seconds.map(|seconds| seconds / steps as f64), simulation.positions())
}

/// Compiles the loop into a folder.
pub fn compile(folder: &Path) -> PathBuf {
    let program = folder.join("explicit");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/c_loop/explicit.c");
    let made = Command::new("cc").args(["-O3", "-march=native", "-o"]).arg(&program).arg(source).arg("-lm").status();
    assert!(made.is_ok_and(|made| made.success()), "explicit.c needs a C compiler");
    program
}

/// Seconds per step of the loop, and where the points are at the end.
pub fn c_loop(program: &Path, network: &Path, result: &Path) -> (f64, Vec<f64>) {
    let made = Command::new(program).args([network, result]).output().expect("it was compiled");
    assert!(made.status.success(), "the C program failed");
    let seconds = String::from_utf8_lossy(&made.stdout).trim().parse().expect("it prints a number");
    let bytes = std::fs::read(result).expect("it was written");
    let x = bytes.as_chunks::<8>().0.iter().map(|x| f64::from_ne_bytes(*x)).collect();
    (seconds, x)
}
