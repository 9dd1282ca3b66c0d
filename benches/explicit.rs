//! What an explicit step costs beside a plain C loop over the same springs, on one core: `Simulation::step`, which
//! `springfit run` takes, without and with the account of energies, against `c_loop/explicit.c`, compiled with `-O3 -march=native`.
//! Both start from the same velocities and end at the same positions. `threads` is how many times faster a step is by the clock on all
//! threads than on one; `f32` is a step without the account in these numbers, `springs/s` its speed, and `apart` the largest distance of its
//! points from those of the loop after 20 steps, relative to the body. `cargo bench --bench explicit`; `-- hex8` for the networks with this in their name.

mod c_loop;
mod clock;

use c_loop::{Case, c_loop, case, compile, cube, exact, springfit, write};
use springfit_bodies::model::Network;
use springfit_element::element::Element;
use springfit_element::material::{Material, State};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight, fit_cells};
use springfit_mesh::mesh::{DiscMesh, Mesh};
use std::sync::Arc;

const ROUNDS: usize = 7;
/// Of each run, about.
const SPRING_STEPS: usize = 20_000_000;

fn classical(mesh: &Mesh, moduli: Material, groups: Option<&[String]>) -> Network {
    let block = &mesh.blocks[0];
    let springs = Springs::select(&block.element, groups).expect("the groups exist");
    let fit = Fit { nonnegative: true, ..Fit::new(Objective::Frobenius(Weight::OffDiagonal)) };
    let moduli = moduli.moduli();
    let fits = fit_cells(&block.element, &springs, &mesh.points, &block.connectivity, moduli, &fit, &mut |_| {});
    Network::assemble(mesh, &[fits.expect("every cell has a content")])
}

fn membrane(name: &'static str, rings: Vec<usize>, radius: f64) -> Case {
    let element = Arc::new(Element::load("tri3").expect("it is shipped"));
    let mesh = DiscMesh { element, radius, height: radius / 5.0, rings }.build().expect("the rings are sound");
    let material = Material::new(10e3, 0.3, State::PlaneStress { thickness: 5e-4 }).expect("it is valid");
    case(name, classical(&mesh, material, None), &mesh, 5e-4, 1e-5)
}

fn main() {
    let folder = tempfile::tempdir().expect("there is room");
    let program = compile(folder.path());
    let groups = ["edge".to_string(), "bulk".to_string()];
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("there is a thread");
    let cases = [
        membrane("membrane", DiscMesh::rings_of(558, 15, 64), 5e-3),
        membrane("membrane", DiscMesh::even(105), 5e-3 * 105.0 / 13.5),
        cube("tet4, rest lengths and volumes", "tet4", 20, |mesh, material| classical(mesh, material, Some(&groups))),
        cube("tet4, exact", "tet4", 20, exact),
        cube("tet4, exact", "tet4", 50, exact),
        cube("hex8, exact", "hex8", 20, exact),
    ];
    println!("median nanoseconds of processor time per spring and step, {ROUNDS} rounds in turn");
    println!(
        "{:32} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8}",
        "network", "springs", "C", "step", "ratio", "account", "threads", "f32", "springs/s", "apart"
    );
    let asked = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).unwrap_or_default();
    for case in cases.iter().filter(|case| case.name.contains(&asked)) {
        let springs = case.network.len();
        let steps = (SPRING_STEPS / springs).max(10);
        let (network, result) = (folder.path().join("network"), folder.path().join("result"));
        // Short of the time in which a difference of rounding grows.
        write(case, 20, &network);
        let there = c_loop(&program, &network, &result).1;
        let apart = |here: Vec<f64>| here.iter().zip(&there).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let size = there.iter().fold(0.0f64, |size, x| size.max(x.abs()));
        for account in [false, true] {
            let apart = apart(springfit::<f64>(case, 20, account).1);
            assert!(apart < 1e-12 * size, "{}: {apart:e} m apart from the C loop", case.name);
        }
        let single_apart = apart(springfit::<f32>(case, 20, false).1) / size;
        write(case, steps, &network);
        let mut runs = [const { Vec::new() }; 6];
        for _ in 0..ROUNDS {
            runs[0].push(c_loop(&program, &network, &result).0);
            let [own, alone] = one.install(|| springfit::<f64>(case, steps, false).0);
            let [_, together] = springfit::<f64>(case, steps, false).0;
            let [account, _] = one.install(|| springfit::<f64>(case, steps, true).0);
            let [single, _] = one.install(|| springfit::<f32>(case, steps, false).0);
            [own, account, alone, together, single]
                .into_iter()
                .zip(&mut runs[1..])
                .for_each(|(run, runs)| runs.push(run));
        }
        let [c, step, account, alone, together, single] = runs.map(|mut runs| {
            runs.sort_by(f64::total_cmp);
            1e9 * runs[ROUNDS / 2] / springs as f64
        });
        println!(
            "{:32} {springs:8} {c:8.2} {step:8.2} {:8.2} {account:8.2} {:8.2} {single:8.2} {:10.2e} {single_apart:8.1e}",
            case.name,
            step / c,
            alone / together,
            1e9 / single
        );
    }
}
