//! What a step costs with one term of `[material.relaxation]` beside the same step of the elastic network, on one core: stable neo-Hookean bodies in
//! explicit steps and in implicit ones, without and with the account of energies. All in turn in one run. `cargo bench --bench relaxing`.

mod clock;

use clock::clock;
use springfit_bodies::dynamics::{
    BranchForm, BranchTerm, FlowMemory, Integrator, LargeMemory, Memory, Motion, Options, Simulation, StepOutcome,
};
use springfit_bodies::model::{MaterialPoints, Network, Support, masses};
use springfit_element::element::Element;
use springfit_element::material::{Material, MaterialMap, Relaxation, RelaxationTerm, State, with_moduli};
use springfit_fit::fit::{ExactEnergy, ExactFit, ShearSprings, fit_exact};
use springfit_mesh::mesh::{BoxMesh, Mesh};
use std::sync::Arc;

const ROUNDS: usize = 7;
/// The share of the shear modulus that relaxes, and its time, s.
const SHARE: f64 = 0.5;
const TIME: f64 = 0.02;

fn body(element: &str, side: usize) -> Mesh {
    let element = Arc::new(Element::load(element).expect("it is shipped"));
    let spec = BoxMesh { element, size: vec![0.1; 3], cells: vec![side; 3], origin: vec![0.0; 3] };
    let mut mesh = spec.build().expect("the cells fill a box");
    let mut state = 1u64;
    for x in &mut mesh.points {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        *x += 0.01 / side as f64 * ((state >> 11) as f64 / (1u64 << 52) as f64 - 1.0);
    }
    mesh
}

fn network(mesh: &Mesh, material: Material) -> Network {
    let block = &mesh.blocks[0];
    let fit = ExactFit { energy: ExactEnergy::StableNeoHookean, large: true, ..ExactFit::default() };
    let cells = fit_exact(&block.element, &mesh.points, &block.connectivity, material, &fit, &mut |_| {});
    Network::assemble(mesh, &[cells.expect("every cell has a volume")])
}

/// What relaxes in a motion.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Elastic,
    Term,
    Yields,
}

fn memory(mesh: &Mesh, material: Material, kind: Kind) -> Option<Memory> {
    let map: MaterialMap = material.into();
    let points = MaterialPoints::of(mesh, &map, ShearSprings::Cells).expect("the cells are solid");
    let term = RelaxationTerm { shear: SHARE, bulk: 0.0, time: TIME, yield_stress: None };
    let series = Relaxation::new(vec![term]).expect("it is valid");
    match kind {
        Kind::Elastic => None,
        Kind::Term => {
            let memory = LargeMemory::new(points, BranchForm::Edges, &mesh.points, &series).expect("it has a shape");
            Some(Memory::Large(Box::new(memory)))
        }
        Kind::Yields => {
            let term = BranchTerm { time: TIME, yield_stress: Some(100.0), shares: vec![SHARE] };
            let memory = FlowMemory::new(points, &mesh.points, &[term]).expect("it has a shape");
            Some(Memory::Flow(Box::new(memory)))
        }
    }
}

fn main() {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    one.install(|| {
        println!("median processor time of a step on one core, {ROUNDS} rounds in turn; ratios to the elastic network");
        println!(
            "{:6} {:>8} {:10} {:>8} {:>12} {:>9} {:>9}",
            "cells", "", "steps", "account", "us, elastic", "one term", "yields"
        );
        for (element, side) in [("tet4", 14), ("tet4", 26), ("hex8", 12)] {
            compare(element, side);
        }
    });
}

fn compare(element: &str, side: usize) {
    let mesh = body(element, side);
    let material = Material::new(1e4, 0.3, State::Solid).expect("it is valid");
    let rest = with_moduli(material, 1.0 - SHARE, 1.0).expect("it is valid");
    let (elastic, left) = (network(&mesh, material), network(&mesh, rest));
    let (elastic, left) = (elastic.prepared(), left.prepared());
    let masses = masses(&mesh, 1000.0, 1.0);
    let mut support = Support::free(&mesh);
    support.fix(&mesh.groups["zmin"].points, &[0, 1, 2], 3);
    let start: Vec<f64> = mesh.points.iter().map(|x| 1e-2 * x).collect();
    for (integrator, step, name) in
        [(Integrator::SymplecticEuler, 5e-5, "explicit"), (Integrator::ImplicitEuler, 2e-3, "implicit")]
    {
        // A factor of many points takes long.
        if name == "implicit" && mesh.point_count() > 5000 {
            continue;
        }
        for account in [false, true] {
            let steps = if name == "explicit" { 400_000 / mesh.cell_count() + 5 } else { 3 };
            let options = Options { step, integrator, account, ..Options::default() };
            let kinds = [Kind::Elastic, Kind::Term, Kind::Yields];
            let mut all: Vec<Simulation> = kinds
                .iter()
                .map(|kind| {
                    let memory = memory(&mesh, material, *kind);
                    let model: &dyn springfit_bodies::model::Elastic = if memory.is_none() { &elastic } else { &left };
                    let motion =
                        Motion { support: support.clone(), memory, ..Motion::free(model, &mesh.points, &masses) };
                    let mut simulation = Simulation::new(motion, options).expect("the model is sound");
                    simulation.start(&start, &vec![0.0; start.len()]).expect("it has a response");
                    simulation
                })
                .collect();
            let mut runs = vec![Vec::new(); all.len()];
            for _ in 0..ROUNDS {
                for (simulation, runs) in all.iter_mut().zip(&mut runs) {
                    let from = clock();
                    for _ in 0..steps {
                        assert_ne!(simulation.step().outcome, StepOutcome::NoResponse);
                    }
                    runs.push(1e6 * (clock() - from) / steps as f64);
                }
            }
            let median = |mut values: Vec<f64>| {
                values.sort_by(f64::total_cmp);
                values[values.len() / 2]
            };
            let ratio = |a: usize| median(runs[a].iter().zip(&runs[0]).map(|(a, b)| a / b).collect());
            println!(
                "{element:6} {:8} {name:10} {account:>8} {:12.1} {:9.2} {:9.2}",
                mesh.cell_count(),
                median(runs[0].clone()),
                ratio(1),
                ratio(2)
            );
        }
    }
}
