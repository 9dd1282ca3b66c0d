//! What springfit takes beside other programs for the same work, each pair in one run on one thread: NumPy, scikit-fem, CHOLMOD, PETSc,
//! pyamg, and loops in C and in Rust. `cargo bench --bench peers`; `-- --write` writes the table of the book's page *Speed*, `-- program` measures
//! the program alone.
//!
//! `PYTHON` names an interpreter with numpy, scipy, scikit-fem, cvxopt, pyamg and petsc4py. What is absent is "not run" and says why.

mod c_loop;
mod clock;
mod program;

use springfit_bodies::model::{BlockStiffness, Support, finite_elements};
use springfit_bodies::solve::{Levels, StaticSolver, System};
use springfit_element::element::Element;
use springfit_element::material::{CellMap, Hooke, Material, State};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Weight, fit_cells};
use springfit_mesh::mesh::{BoxMesh, CellBlock, Mesh};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

/// Seconds of the processor and of the clock, a number that a peer must agree in, and words.
struct Figures {
    processor: f64,
    wall: f64,
    number: f64,
    name: String,
}

/// A line of the table.
struct Row {
    work: String,
    own: Figures,
    peer: Result<Figures, String>,
}

fn timed<T>(name: &str, work: impl FnOnce() -> T, number: impl FnOnce(&T) -> f64) -> Figures {
    let (processor, start) = (clock::clock(), Instant::now());
    let done = work();
    let (processor, wall) = (clock::clock() - processor, start.elapsed().as_secs_f64());
    Figures { processor, wall, number: number(&done), name: name.into() }
}

/// What a script prints.
fn python(script: &str, arguments: &[&str]) -> Result<String, String> {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches").join(script);
    let mut command = Command::new(&python);
    for threads in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"] {
        command.env(threads, "1");
    }
    let output = command.arg(script).args(arguments).output().map_err(|e| format!("{python}: {e}"))?;
    let last = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().lines().last().unwrap_or("").to_string();
    if output.status.success() { Ok(last(&output.stdout)) } else { Err(last(&output.stderr)) }
}

fn peer(work: &str, folder: &Path) -> Result<Figures, String> {
    let line = python("peers.py", &[work, &folder.to_string_lossy()])?;
    let words: Vec<&str> = line.split('\t').collect();
    let [processor, wall, number, name] = words[..] else { return Err(format!("printed {line:?}")) };
    let parse = |text: &str| text.parse().map_err(|_| format!("printed {line:?}"));
    Ok(Figures { processor: parse(processor)?, wall: parse(wall)?, number: parse(number)?, name: name.into() })
}

/// A box of a metre whose points are moved by up to a fifth of a cell.
fn body(element: &str, cells: usize) -> Mesh {
    let element = Arc::new(Element::load(element).expect("it is shipped"));
    let spec = BoxMesh { element, size: vec![1.0; 3], cells: vec![cells; 3], origin: vec![0.0; 3] };
    let mut mesh = spec.build().expect("the cells fill a box");
    let mut state = 1_u64;
    for x in mesh.points.iter_mut().filter(|x| **x > 1e-9 && **x < 1.0 - 1e-9) {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        *x += 0.2 / cells as f64 * ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0);
    }
    mesh
}

fn write(folder: &Path, name: &str, bytes: impl IntoIterator<Item = u8>) {
    std::fs::write(folder.join(name), bytes.into_iter().collect::<Vec<u8>>()).expect("the folder can be written");
}

/// The body, held at one side and pulled at the other, as `peers.py` reads it.
fn export(folder: &Path, mesh: &Mesh, stiffness: &BlockStiffness, support: &Support, force: &[f64]) {
    let (starts, columns, values) = stiffness.parts();
    write(folder, "points", mesh.points.iter().flat_map(|x| x.to_ne_bytes()));
    write(folder, "cells", mesh.blocks[0].connectivity.iter().flat_map(|p| (*p as i64).to_ne_bytes()));
    write(folder, "starts", starts.iter().flat_map(|x| (*x as i32).to_ne_bytes()));
    write(folder, "columns", columns.iter().flat_map(|x| (*x as i32).to_ne_bytes()));
    write(folder, "values", values.iter().flat_map(|x| x.to_ne_bytes()));
    write(folder, "force", force.iter().flat_map(|x| x.to_ne_bytes()));
    write(folder, "held", support.prescribed.iter().map(|u| u8::from(u.is_some())));
}

fn fits(folder: &Path, material: Material) -> Row {
    let mesh = body("tet4", 32);
    let CellBlock { element, connectivity, .. } = &mesh.blocks[0];
    let nodes = connectivity.iter().flat_map(|&p| mesh.point(p)).flat_map(|x| x.to_ne_bytes());
    write(folder, "nodes", nodes);
    let edges = ["edge".to_string()];
    let springs = Springs::select(element, Some(&edges)).expect("tetrahedra have edges");
    let fit = Fit::new(Objective::Frobenius(Weight::None));
    let work = || fit_cells(element, &springs, &mesh.points, connectivity, material.moduli(), &fit, &mut |_| {});
    let sum = |fits: &Result<_, _>| {
        fits.as_ref().map_or(f64::NAN, |fits: &springfit_fit::fit::CellFits| fits.constants.iter().sum())
    };
    let own = timed("springfit", work, sum);
    let found = python("numpy_tet4.py", &[&folder.join("nodes").to_string_lossy()]);
    let peer = found.and_then(|line| {
        let figures: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let [seconds, number] = figures[..] else { return Err(format!("printed {line:?}")) };
        Ok(Figures { processor: seconds, wall: seconds, number, name: "NumPy, batched".into() })
    });
    Row { work: format!("Frobenius fit of {} tet4", mesh.cell_count()), own, peer }
}

fn bodies(folder: &Path, cells: usize, material: Material, rows: &mut Vec<Row>) {
    let mesh = body("hex8", cells);
    let unknowns = mesh.points.len();
    let moduli: CellMap<Hooke> = material.moduli().into();
    let mut support = Support::free(&mesh);
    support.fix(&mesh.groups["xmin"].points, &[0, 1, 2], 3);
    let mut force = vec![0.0; unknowns];
    mesh.groups["xmax"].points.iter().for_each(|p| force[3 * p..3 * p + 3].copy_from_slice(&[0.3, -1.0, 0.2]));
    let weights = |n: usize| (0..unknowns).map(|i| (1 + i % n) as f64).collect::<Vec<f64>>();
    let number = |stiffness: &BlockStiffness| {
        let product = stiffness.apply(&weights(5));
        weights(7).iter().zip(product).map(|(u, f)| u * f).sum()
    };
    let assemble = || BlockStiffness::of_body(&mesh, moduli.clone(), 1, 1).expect("it fits into memory");
    let own = timed("springfit", assemble, number);
    let stiffness = assemble();
    export(folder, &mesh, &stiffness, &support, &force);
    rows.push(Row { work: format!("assembly of {cells}³ hex8"), own, peer: peer("assembly", folder) });
    let largest = |u: &[f64]| u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    if unknowns < 120_000 {
        let entries = finite_elements(&mesh, moduli.clone());
        let system = System::new(&entries, &support).expect("it fits into memory").placed(&mesh.points, 3);
        drop(entries);
        let solve = || {
            let factor = system.cholesky().expect("it fits into memory").expect("the body is held");
            system.solve_all(&factor, std::slice::from_ref(&force)).remove(0)
        };
        let own = timed("springfit", solve, |u| largest(u));
        rows.push(Row { work: format!("Cholesky, one load, {unknowns} unknowns"), own, peer: peer("factor", folder) });
    }
    let solver = StaticSolver { tolerance: 1e-8, ..StaticSolver::default() };
    let mut iterations = 0;
    let solve = || {
        let levels = Levels::new(stiffness.clone(), &mesh.points, &support).expect("its points group");
        let levels = levels.expect("the body is held");
        let (u, solved) = levels.solve(&force, &solver, &mut |_| ()).expect("it converges");
        iterations = solved.iterations.unwrap_or(0);
        u
    };
    let mut own = timed("", solve, |_| f64::NAN);
    own.name = format!("springfit, {iterations} iterations");
    for name in ["petsc", "pyamg"] {
        let work = format!("multigrid, one load, {unknowns} unknowns");
        let own = Figures { name: own.name.clone(), ..own };
        rows.push(Row { work, own, peer: peer(name, folder) });
    }
}

/// A thousand steps of an exact network.
fn steps(folder: &Path) -> Row {
    let case = c_loop::cube("tet4, exact", "tet4", 20, c_loop::exact);
    let (program, network) = (c_loop::compile(folder), folder.join("network"));
    let count = 300;
    c_loop::write(&case, count, &network);
    let (c, _) = c_loop::c_loop(&program, &network, &folder.join("result"));
    let ([own, _], _) = c_loop::springfit::<f64>(&case, count, false);
    let figures = |seconds: f64, name: &str| {
        let total = 1000.0 * seconds;
        Figures { processor: total, wall: f64::NAN, number: f64::NAN, name: name.into() }
    };
    let work = format!("1000 explicit steps, {}, {} springs", case.name, case.network.len());
    Row { work, own: figures(own, "springfit"), peer: Ok(figures(c, "C, cc -O3 -march=native")) }
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| work | program | processor, s | clock, s | peer | processor, s | clock, s | ratio |\n|---|---|---|---|---|---|---|---|\n",
    );
    let seconds = |s: f64| if s.is_nan() { "–".into() } else { format!("{s:.3}") };
    for Row { work, own, peer } in rows {
        let own_text = format!("{} | {} | {}", own.name, seconds(own.processor), seconds(own.wall));
        let peer = match peer {
            Ok(peer) => format!(
                "{} | {} | {} | {:.2}",
                peer.name,
                seconds(peer.processor),
                seconds(peer.wall),
                peer.processor / own.processor
            ),
            Err(why) => format!("not run: {} | – | – | –", why.replace('|', "/")),
        };
        writeln!(text, "| {work} | {own_text} | {peer} |").expect("a text takes all");
    }
    text
}

fn machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = text.lines().find(|line| line.starts_with("model name")).and_then(|line| line.split(": ").nth(1));
    model.unwrap_or("a machine that does not name its processor").into()
}

fn main() {
    let folder = tempfile::tempdir().expect("there is room");
    let material = Material::new(1e4, 0.3, State::Solid).expect("it is valid");
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    faer::set_global_parallelism(faer::Par::Seq);
    let mut rows = Vec::new();
    let given = |word: &str| std::env::args().any(|argument| argument == word);
    let is_whole = !given("program");
    if is_whole {
        rows.push(one.install(|| fits(folder.path(), material)));
        for cells in [20, 30, 45] {
            one.install(|| bodies(folder.path(), cells, material, &mut rows));
        }
        rows.push(one.install(|| steps(folder.path())));
    }
    rows.extend(one.install(|| program::files(folder.path())));
    for Row { work, own, peer } in &rows {
        let Ok(peer) = peer else { continue };
        let apart = (own.number - peer.number).abs() / own.number.abs();
        assert!(
            own.number.is_nan() || apart < 1e-8,
            "{work}: {:e} of springfit, {:e} of {}",
            own.number,
            peer.number,
            peer.name
        );
    }
    let bounds = program::bounds(folder.path());
    let text = format!("One thread, {}:\n\n{}\nThe program, with its bounds:\n\n{bounds}", machine(), table(&rows));
    println!("{text}");
    if is_whole && given("--write") {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/src/studies/speed.md");
        let old = std::fs::read_to_string(&page).expect("the book has the page");
        let (before, rest) = old.split_once("<!-- peers -->\n").expect("the page has a place for the table");
        let (_, after) = rest.split_once("<!-- end peers -->").expect("its end is marked");
        std::fs::write(&page, format!("{before}<!-- peers -->\n{text}<!-- end peers -->{after}"))
            .expect("it can be written");
    }
}
