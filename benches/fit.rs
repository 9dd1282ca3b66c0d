//! Time per element of every objective on every shipped element, on jittered boxes; and a million tetrahedra beside a
//! batched NumPy implementation of the same fit, in the same run. Medians of five runs.

use springfit_bodies::model::Network;
use springfit_element::element::{Element, SHIPPED};
use springfit_element::material::{Energy, Hooke, Material, State, Stiffness};
use springfit_element::springs::{Force, Law, Springs};
use springfit_fit::fit::{
    Balance, CellFits, ExactFit, Fit, Higher, MotionWeight, Objective, SampledFit, Sampling, VolumeSprings, Weight,
    Weights, fit_cells, fit_exact, fit_sampled,
};
use springfit_mesh::mesh::{BoxMesh, CellBlock, Mesh};
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

/// A unit box of about `count` cells, each point moved by up to a tenth of a cell, less where nodes are closer; none of an
/// element whose cells fill no box.
fn jittered(element: &Element, count: usize) -> Option<Mesh> {
    let d = element.dimension();
    let element = Arc::new(element.clone());
    let with = |side: usize| {
        let spec = BoxMesh { element: element.clone(), size: vec![1.0; d], cells: vec![side; d], origin: vec![0.0; d] };
        spec.build().ok()
    };
    let per_cube = with(1)?.cell_count();
    let side = ((count / per_cube).max(1) as f64).powf(1.0 / d as f64).ceil() as usize;
    let mut mesh = with(side)?;
    let order = element.nodes() as f64 / element.cell.corners().len() as f64;
    let mut state = 1u64;
    for x in &mut mesh.points {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        *x += 0.1 / side as f64 / order * ((state >> 11) as f64 / (1u64 << 52) as f64 - 1.0);
    }
    Some(mesh)
}

/// The constants, and the median seconds of five fits into memory that a first one has touched.
fn timed(mesh: &Mesh, fit: Fit) -> (CellFits, f64) {
    let moduli = Material::for_body(mesh.dimension, 1e4, 0.3, None, None).expect("it is valid").moduli();
    timed_under(mesh, &moduli.into(), fit)
}

fn timed_under(mesh: &Mesh, law: &Hooke, fit: Fit) -> (CellFits, f64) {
    let CellBlock { element, connectivity, .. } = &mesh.blocks[0];
    let springs = Springs::select(element, None).expect("no group is named");
    let fits = fit_cells(element, &springs, &mesh.points, connectivity, law.clone(), &fit, &mut |_| {});
    let mut fits = fits.expect("every cell has a volume");
    let mut runs: Vec<f64> = (0..5)
        .map(|_| {
            let start = Instant::now();
            let again = fits.refit(element, &mesh.points, connectivity, law.clone(), &fit, &mut |_| {});
            again.expect("every cell has a volume");
            start.elapsed().as_secs_f64()
        })
        .collect();
    runs.sort_by(f64::total_cmp);
    (fits, runs[2])
}

/// The median seconds of five runs after a first, each of which asks for its memory anew.
fn anew(mut run: impl FnMut() -> CellFits) -> f64 {
    let mut runs: Vec<f64> = (0..6)
        .map(|_| {
            let start = Instant::now();
            let fits = run();
            let seconds = start.elapsed().as_secs_f64();
            drop(fits);
            seconds
        })
        .skip(1)
        .collect();
    runs.sort_by(f64::total_cmp);
    runs[2]
}

/// The objectives with closed forms under a law of 21 independent constants.
fn anisotropic(mesh: &Mesh) -> [(&'static str, f64); 3] {
    let entry = |(i, j): (usize, usize)| if i == j { 1e4 } else { 1e3 * (i + j) as f64 / 4.0 };
    let entries: Vec<f64> = (0..36).map(|e| entry((e / 6, e % 6))).collect();
    let law = Hooke::Anisotropic(Stiffness::new(3, &entries).expect("it is positive definite"));
    let time = |weight| timed_under(mesh, &law, Fit::new(Objective::Frobenius(weight))).1;
    [
        ("frobenius, anisotropic", time(Weight::None)),
        ("offdiag, anisotropic", time(Weight::OffDiagonal)),
        ("modal 0.316, anisotropic", time(Weight::Modal(Higher::DEFAULT))),
    ]
}

/// Exact networks beside those of the default objective.
fn exact(mesh: &Mesh) -> [(&'static str, f64); 3] {
    let CellBlock { element, connectivity, .. } = &mesh.blocks[0];
    let material = Material::for_body(mesh.dimension, 1e4, 0.3, None, None).expect("it is valid");
    let springs = Springs::select(element, None).expect("no group is named");
    let fit = Fit::new(Objective::Frobenius(Weight::OffDiagonal));
    let default = anew(|| {
        let moduli = material.moduli();
        let fits = fit_cells(element, &springs, &mesh.points, connectivity, moduli, &fit, &mut |_| {});
        fits.expect("every cell has a volume")
    });
    let exact = |volume: VolumeSprings| {
        let fit = ExactFit { volume, ..ExactFit::default() };
        anew(|| {
            let fits = fit_exact(element, &mesh.points, connectivity, material, &fit, &mut |_| {});
            fits.expect("every cell has a volume")
        })
    };
    [
        ("offdiag, into new memory", default),
        ("exact, into new memory", exact(VolumeSprings::Points)),
        ("exact, volume of cells", exact(VolumeSprings::Cells)),
    ]
}

fn main() {
    // `cargo bench -- tet4` times that element alone, `sampled` the sampled fits, `network` the way to a whole network.
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    println!("on one core");
    println!("{:10} {:28} {:>14} {:>16}", "element", "fit", "ns/element", "elements/s");
    let every: Vec<Element> = SHIPPED.iter().map(|s| Element::shipped(s).expect("it is shipped")).collect();
    // Of the others `cargo bench -- hex27` tells.
    let common = |e: &Element| e.nodes() == e.cell.corners().len() && e.dimension() > 1;
    let wanted = |e: &&Element| if chosen.is_empty() { common(e) } else { chosen.contains(&e.name) };
    for element in every.iter().filter(wanted) {
        let springs = element.nodes() * (element.nodes() - 1) / 2;
        let count = (25_000_000 / (springs * springs)).clamp(64, 30_000);
        let (Some(mesh), Some(small)) = (jittered(element, count), jittered(element, count / 30)) else { continue };
        let frobenius = [Weight::None, Weight::OffDiagonal, Weight::Modal(Higher::DEFAULT), Weight::Relative];
        let mut fits: Vec<(Fit, &Mesh)> = frobenius.map(|w| (Fit::new(Objective::Frobenius(w)), &mesh)).into();
        let weights = [MotionWeight::None, MotionWeight::Modal(Higher::DEFAULT), MotionWeight::Relative];
        for (weight, gap) in weights.iter().flat_map(|w| [(w, 0.0), (w, 1e-8)]) {
            fits.push((Fit { gap, ..Fit::new(Objective::Spectral(*weight)) }, &small));
        }
        fits.push((Fit::new(Objective::Divergence(Balance::DEFAULT)), &small));
        for (fit, mesh) in fits {
            for nonnegative in [false, true] {
                let (_, seconds) = one.install(|| timed(mesh, Fit { nonnegative, ..fit }));
                let each = seconds / mesh.cell_count() as f64;
                let gap = if fit.gap > 0.0 { format!(", gap {:e}", fit.gap) } else { String::new() };
                let name = format!("{}{gap}{}", fit.objective.title(), if nonnegative { ", k >= 0" } else { "" });
                println!("{:10} {name:28} {:14.0} {:16.0}", element.name, 1e9 * each, 1.0 / each);
            }
        }
        if element.dimension() == 3 {
            for (name, seconds) in one.install(|| anisotropic(&mesh)) {
                let each = seconds / mesh.cell_count() as f64;
                println!("{:10} {name:28} {:14.0} {:16.0}", element.name, 1e9 * each, 1.0 / each);
            }
        }
        for (name, seconds) in one.install(|| exact(&mesh)) {
            let each = seconds / mesh.cell_count() as f64;
            println!("{:10} {name:28} {:14.0} {:16.0}", element.name, 1e9 * each, 1.0 / each);
        }
    }
    let part = |name: &str| chosen.is_empty() || chosen.iter().any(|c| c == name);
    if part("sampled") {
        sampled();
    }
    if part("network") {
        beside_numpy();
    }
}

/// Constants from the forces at a thousand deformed shapes, per element on one core.
fn sampled() {
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    for name in ["tet4", "hex8"] {
        let element = Element::load(name).expect("it is shipped");
        let mesh = jittered(&element, 24).expect("it fills a box");
        let material = Material::for_body(3, 1e4, 0.3, None, None).expect("it is valid");
        let energy = Energy::load("neo-hookean", material).expect("it is shipped");
        let CellBlock { element, connectivity, .. } = &mesh.blocks[0];
        let springs = Springs::select(element, None).expect("no group is named");
        let law = |text: &str| Force::of_all(Law::parse(text).expect("it is a law"), springs.names().len());
        let linear = Sampling { shapes: 1000, held_out: 0, ..Sampling::default() };
        for (title, sampling, force) in [
            ("sampled, 1000 shapes", linear, Force::Linear),
            ("sampled, k*(exp(a*s) - 1)", Sampling::default(), law("k*(exp(a*s) - 1)")),
            ("sampled, a*s/(1 + b*s^2)", Sampling::default(), law("a*s/(1 + b*s^2)")),
        ] {
            let fit = SampledFit { sampling, force, weights: Weights::Relative, ..SampledFit::default() };
            let start = Instant::now();
            let fit =
                || fit_sampled(element, &springs, &mesh.points, connectivity, &energy, State::Solid, &fit, &mut |_| {});
            let found = one.install(fit).expect("the shapes are upright");
            let (cells, each) = (mesh.cell_count(), start.elapsed().as_secs_f64() / mesh.cell_count() as f64);
            let (reached, error) = (cells - found.fits.unreached, found.trained.iter().sum::<f64>() / cells as f64);
            println!("{name:10} {title:28} {:14.0} {reached:5} of {cells} cells, error {error:.4}", 1e9 * each);
        }
    }
}

/// From a mesh in memory to the springs of the whole body, on all cores.
fn network(mesh: &Mesh) {
    let CellBlock { element, connectivity, .. } = &mesh.blocks[0];
    let springs = Springs::select(element, None).expect("no group is named");
    let moduli = Material::for_body(mesh.dimension, 1e4, 0.3, None, None).expect("it is valid").moduli();
    let fit = Fit::new(Objective::Frobenius(Weight::None));
    let run = || {
        let start = Instant::now();
        let fits = fit_cells(element, &springs, &mesh.points, connectivity, moduli, &fit, &mut |_| {});
        let fits = [fits.expect("every cell has a volume")];
        let fitted = start.elapsed().as_secs_f64();
        let network = Network::assemble(mesh, &fits);
        (start.elapsed().as_secs_f64(), fitted, network.len())
    };
    let mut runs: Vec<_> = (0..5).map(|_| run()).collect();
    runs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ((seconds, fitted, count), cells) = (runs[2], mesh.cell_count() as f64);
    println!(
        "to a network of {count} springs: {seconds:.3} s ({fitted:.3} s of it the fit, into new memory), {:.0} ns each, {:.1} \
         million elements/s",
        1e9 * seconds / cells,
        1e-6 * cells / seconds
    );
}

fn beside_numpy() {
    let tetrahedron = Element::load("tet4").expect("it is shipped");
    let mesh = jittered(&tetrahedron, 1_000_000).expect("tetrahedra fill a box");
    let (fits, seconds) = timed(&mesh, Fit::new(Objective::Frobenius(Weight::None)));
    let cells = mesh.cell_count();
    let threads = rayon::current_num_threads();
    println!("\n{cells} tet4, frobenius, {threads} cores: {seconds:.3} s, {:.0} ns each", 1e9 * seconds / cells as f64);
    network(&mesh);
    let nodes: Vec<u8> =
        mesh.blocks[0].connectivity.iter().flat_map(|&p| mesh.point(p)).flat_map(|x| x.to_ne_bytes()).collect();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("nodes.f64");
    std::fs::write(&file, nodes).expect("room for the nodes");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/numpy_tet4.py");
    let Ok(output) = Command::new("python3").arg(script).arg(&file).output() else {
        return println!("python3 is not installed: no comparison with NumPy");
    };
    let text = String::from_utf8_lossy(&output.stdout);
    let figures: Vec<f64> = text.split_whitespace().filter_map(|t| t.parse().ok()).collect();
    let [numpy, sum] = figures[..] else {
        return println!("the comparison with NumPy did not run:\n{}", String::from_utf8_lossy(&output.stderr));
    };
    let ours: f64 = fits.constants.iter().sum();
    println!("NumPy, one thread:            {numpy:.3} s, {:.0} ns per element", 1e9 * numpy / cells as f64);
    println!("ratio {:.1}; the sums of all constants agree to {:.0e}", numpy / seconds, ((ours - sum) / sum).abs());
}
