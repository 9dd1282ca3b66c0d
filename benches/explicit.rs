//! What an explicit step costs beside a plain C loop over the same springs, on one core: `Simulation::step`, which
//! `springfit run` takes, without and with the account of energies, against `explicit.c`, compiled with `-O3 -march=native`.
//! Both start from the same velocities and end at the same positions. `cargo bench --bench explicit`;
//! `-- hex8` for the networks with this in their name.

use springfit::dynamics::{Integrator, Motion, Options, Simulation};
use springfit::element::Element;
use springfit::fit::{ExactEnergy, ExactFit, Fit, Objective, Weight, fit_cells, fit_exact};
use springfit::material::{Material, State};
use springfit::mesh::{BoxMesh, DiscMesh, Mesh};
use springfit::model::{LengthSpring, Network, masses};
use springfit::springs::{Measure, Springs};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

const ROUNDS: usize = 7;
/// Of each run, about.
const SPRING_STEPS: usize = 20_000_000;

/// A body that is not at rest: its network, its points, moved from rest, and its masses.
struct Case {
    name: &'static str,
    network: Network,
    points: Vec<f64>,
    masses: Vec<f64>,
    step: f64,
}

fn classical(mesh: &Mesh, moduli: Material, groups: Option<&[String]>) -> Network {
    let block = &mesh.blocks[0];
    let springs = Springs::select(&block.element, groups).expect("the groups exist");
    let fit = Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(Weight::OffDiagonal)) };
    let moduli = moduli.moduli();
    let fits = fit_cells(&block.element, &springs, &mesh.points, &block.connectivity, moduli, &fit, &mut |_| {});
    Network::assemble(mesh, &[fits.expect("every cell has a content")])
}

fn exact(mesh: &Mesh, material: Material) -> Network {
    let block = &mesh.blocks[0];
    let fit = ExactFit { energy: ExactEnergy::StableNeoHookean, large: true, ..ExactFit::default() };
    let cells = fit_exact(&block.element, &mesh.points, &block.connectivity, material, &fit, &mut |_| {});
    Network::assemble(mesh, &[cells.expect("every cell has a volume")])
}

fn membrane(name: &'static str, rings: Vec<usize>, radius: f64) -> Case {
    let element = Arc::new(Element::load("tri3").expect("it is shipped"));
    let mesh = DiscMesh { element, radius, height: radius / 5.0, rings }.build().expect("the rings are sound");
    let material = Material::new(10e3, 0.3, State::PlaneStress { thickness: 5e-4 }).expect("it is valid");
    case(name, classical(&mesh, material, None), &mesh, 5e-4, 1e-5)
}

fn cube(name: &'static str, element: &str, cells: usize, network: impl Fn(&Mesh, Material) -> Network) -> Case {
    let element = Arc::new(Element::load(element).expect("it is shipped"));
    let spec = BoxMesh { element, size: vec![1.0; 3], cells: vec![cells; 3], origin: vec![0.0; 3] };
    let mesh = spec.build().expect("the cells fill a box");
    let material = Material::new(1e4, 0.3, State::Solid).expect("it is valid");
    case(name, network(&mesh, material), &mesh, 1.0, 1e-4)
}

fn case(name: &'static str, network: Network, mesh: &Mesh, thickness: f64, step: f64) -> Case {
    let size = mesh.points.iter().fold(0.0f64, |size, x| size.max(x.abs()));
    let points = mesh.points.iter().map(|x| 1.01 * x + 1e-3 * size * (20.0 * x / size).sin()).collect();
    Case { name, network, points, masses: masses(mesh, 1000.0, thickness), step }
}

/// The network as the C program reads it.
fn write(case: &Case, steps: usize, to: &Path) {
    let Case { network, points, masses, step, .. } = case;
    let (bars, edges): (Vec<&LengthSpring>, Vec<&LengthSpring>) = network.lengths.iter().partition(|s| s.rest != 0.0);
    let (mut tets, mut hexes, mut table) = (Vec::new(), Vec::new(), Vec::new());
    for spring in &network.others {
        let (scale, is_hex) = match &spring.measure {
            Measure::Content(element) => (1.0 / 6.0, element.nodes() == 8),
            Measure::PointContent(element, q) => {
                table.clone_from(&element.tabulation.gradients);
                (element.tabulation.point_weight(*q), element.nodes() == 8)
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

/// What the processor has spent on this thread, s.
fn clock() -> f64 {
    std::thread::yield_now();
    let spent = std::fs::read_to_string("/proc/thread-self/schedstat").expect("this bench needs Linux");
    1e-9 * spent.split(' ').next().and_then(|s| s.parse::<f64>().ok()).expect("it begins with a number")
}

/// Seconds per step of the simulation, and where the points are at the end.
fn springfit(case: &Case, steps: usize, account: bool) -> (f64, Vec<f64>) {
    let prepared = case.network.prepared();
    let motion = Motion::free(&prepared, &case.points, &case.masses);
    let options = Options { step: case.step, integrator: Integrator::SymplecticEuler, account, ..Options::default() };
    let mut simulation = Simulation::new(motion, options).expect("the model is sound");
    let from = clock();
    (0..steps).for_each(|_| assert_ne!(simulation.step().outcome, springfit::dynamics::StepOutcome::NoResponse));
    ((clock() - from) / steps as f64, simulation.positions())
}

fn c_loop(program: &Path, network: &Path, result: &Path) -> (f64, Vec<f64>) {
    let made = Command::new(program).args([network, result]).output().expect("it was compiled");
    assert!(made.status.success(), "the C program failed");
    let seconds = String::from_utf8_lossy(&made.stdout).trim().parse().expect("it prints a number");
    let bytes = std::fs::read(result).expect("it was written");
    let x = bytes.as_chunks::<8>().0.iter().map(|x| f64::from_ne_bytes(*x)).collect();
    (seconds, x)
}

fn main() {
    let folder = tempfile::tempdir().expect("there is room");
    let program = folder.path().join("explicit");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/explicit.c");
    let made = Command::new("cc").args(["-O3", "-march=native", "-o"]).arg(&program).arg(source).arg("-lm").status();
    assert!(made.is_ok_and(|made| made.success()), "explicit.c needs a C compiler");
    let groups = ["edge".to_string(), "bulk".to_string()];
    let cases = [
        membrane("membrane", DiscMesh::rings_of(558, 15, 64), 5e-3),
        membrane("membrane", DiscMesh::even(105), 5e-3 * 105.0 / 13.5),
        cube("tet4, rest lengths and volumes", "tet4", 20, |mesh, material| classical(mesh, material, Some(&groups))),
        cube("tet4, exact", "tet4", 20, exact),
        cube("hex8, exact", "hex8", 20, exact),
    ];
    println!("median nanoseconds of processor time per spring and step, {ROUNDS} rounds in turn");
    println!(
        "{:32} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}",
        "network", "springs", "C", "step", "ratio", "account", "ratio"
    );
    let asked = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).unwrap_or_default();
    for case in cases.iter().filter(|case| case.name.contains(&asked)) {
        let springs = case.network.len();
        let steps = (SPRING_STEPS / springs).max(10);
        let (network, result) = (folder.path().join("network"), folder.path().join("result"));
        // Short of the time in which a difference of rounding grows.
        write(case, 20, &network);
        let there = c_loop(&program, &network, &result).1;
        let here = springfit(case, 20, true).1;
        let apart = here.iter().zip(&there).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let size = there.iter().fold(0.0f64, |size, x| size.max(x.abs()));
        assert!(apart < 1e-12 * size, "{}: {apart:e} m apart from the C loop", case.name);
        write(case, steps, &network);
        let mut runs = [const { Vec::new() }; 3];
        for _ in 0..ROUNDS {
            runs[0].push(c_loop(&program, &network, &result).0);
            runs[1].push(springfit(case, steps, false).0);
            runs[2].push(springfit(case, steps, true).0);
        }
        let [c, step, account] = runs.map(|mut runs| {
            runs.sort_by(f64::total_cmp);
            1e9 * runs[ROUNDS / 2] / springs as f64
        });
        println!("{:32} {springs:8} {c:8.2} {step:8.2} {:8.2} {account:8.2} {:8.2}", case.name, step / c, account / c);
    }
}
