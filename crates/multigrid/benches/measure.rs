//! Assembles, sets up and solves jittered bodies: `measure CASE CELLS [key=value …]`, one line of figures;
//! times are those of the processor.
//! `columns=8` solves for so many forces side by side as well. With `export=FOLDER` the matrix is written for other solvers.

#[path = "../tests/levels/elastic/mod.rs"]
mod elastic;

use elastic::{Body, Shape};
use springfit_multigrid::{Definiteness, Event, Multigrid, Settings, space_motions};
use std::fs;
use std::ops::ControlFlow;

/// Seconds of the processor that this process has taken, on all threads.
fn seconds() -> f64 {
    let text = fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    let own = |path: std::path::PathBuf| fs::read_to_string(path.join("schedstat")).unwrap_or(text.clone());
    let tasks = fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let nanoseconds =
        tasks.map(|task| own(task.path()).split_whitespace().next().unwrap_or("0").parse::<f64>().unwrap_or(0.0));
    1e-9 * nanoseconds.sum::<f64>()
}

fn main() {
    // Cargo adds a word of its own.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    if words.len() < 2 {
        return println!("expected a case and a number of cells, such as: cubes 20");
    }
    let value = |key: &str| words.iter().find_map(|w| w.strip_prefix(key)?.strip_prefix('=')).map(str::to_string);
    let number = |key: &str, otherwise: f64| value(key).map_or(otherwise, |text| text.parse().unwrap());
    let (case, n) = (words[0].as_str(), words[1].parse::<usize>().unwrap());
    let shape = if case == "tetrahedra" { Shape::Simplex } else { Shape::Cube };
    let poisson = if case == "incompressible" { 0.49 } else { 0.3 };
    let stretch = if case == "slivers" { [1.0, 1.0, 0.1] } else { [1.0; 3] };
    let mut body = Body::new([n; 3], stretch, shape, number("jitter", 0.4), poisson);
    if case == "contrast" {
        let mut random = elastic::random(3);
        // Cubes of 5 cells that are a thousand times as stiff.
        let blocks: Vec<bool> = (0..(n / 5 + 1).pow(3)).map(|_| random() > 0.2).collect();
        for cell in 0..body.young.len() {
            let at = |k: u32| cell / n.pow(k) % n / 5;
            let m = n / 5 + 1;
            if blocks[at(0) + m * (at(1) + m * at(2))] {
                body.young[cell] = 1e3;
            }
        }
    }
    let defaults = Settings::default();
    let settings = Settings {
        threshold: number("threshold", defaults.threshold),
        degree: number("degree", defaults.degree as f64) as usize,
        ratio: number("ratio", defaults.ratio),
        dense: number("dense", defaults.dense as f64) as usize,
    };
    let start = seconds();
    let matrix = body.matrix();
    let assembly = seconds() - start;
    let mut force = vec![0.0; body.points.len()];
    let far = body.points.iter().step_by(3).copied().fold(0.0, f64::max);
    for (x, f) in body.points.chunks_exact(3).zip(force.chunks_exact_mut(3)) {
        if x[0] == far {
            f.copy_from_slice(&[0.3, -1.0, 0.2]);
        }
    }
    if let Some(folder) = value("export") {
        export(&folder, &body, &matrix, &force);
    }
    let motions = space_motions(&body.points, &body.is_held);
    let memory = || {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:")).unwrap_or("0").trim().to_string();
        line.split_whitespace().next().unwrap().parse::<f64>().unwrap() / 1e6
    };
    let start = seconds();
    let verbose = value("verbose").is_some();
    let mut watch = |event: Event| {
        if verbose {
            eprintln!("{:.2} s {event:?}", (seconds() - start));
        }
        ControlFlow::Continue(())
    };
    let levels = match Multigrid::new(matrix.clone(), &motions, &body.is_held, &settings, &mut watch) {
        Ok(levels) => levels,
        Err(fault) => return println!("{case} {n}: {fault}"),
    };
    let setup = seconds() - start;
    let start = seconds();
    let solution = match levels.solve(&force, number("tolerance", 1e-8), 500, &mut watch) {
        Ok(solution) => solution,
        Err(fault) => return println!("{case} {n}: {fault}"),
    };
    let solve = seconds() - start;
    let columns = number("columns", 0.0) as usize;
    let several: Vec<Vec<f64>> = (0..columns).map(|i| rotated(&force, i)).collect();
    let several: Vec<&[f64]> = several.iter().map(|force| &force[..]).collect();
    let start = seconds();
    if let Err(fault) = levels.solve_each(&several, number("tolerance", 1e-8), 500, &mut watch) {
        return println!("{case} {n}: {fault}");
    }
    let together = seconds() - start;
    let [low, high] = solution.spectrum;
    let start = seconds();
    let (steps, proof) = match levels.definiteness(1e-12, 3000, &mut watch) {
        Ok(Definiteness::Positive { iterations, .. }) => (iterations, "positive definite"),
        Ok(Definiteness::NotPositive { iterations, .. }) => (iterations, "not positive definite"),
        Ok(Definiteness::Undecided { iterations, .. }) => (iterations, "not decided"),
        Err(fault) => return println!("{case} {n}: {fault}"),
    };
    let proved = seconds() - start;
    println!(
        "{case} {n}: {} unknowns, assembly {assembly:.2} s, setup {setup:.2} s, {} iterations {solve:.2} s, {columns} side by side {together:.2} s, residual {:.1e}, {proof} in {steps} steps {proved:.2} s, spectrum \
         {low:.3} {high:.3}, levels {}, matrix {:.2} GB, levels {:.2} GB, peak {:.2} GB",
        force.len(),
        solution.iterations,
        solution.residual,
        springfit_multigrid::sizes(levels.levels()),
        matrix.bytes() as f64 / 1e9,
        levels.bytes() as f64 / 1e9,
        memory(),
    );
}

/// Another load of the same size: the forces turned by i radians about x.
fn rotated(force: &[f64], i: usize) -> Vec<f64> {
    let (sin, cos) = (i as f64).sin_cos();
    force.chunks_exact(3).flat_map(|f| [f[0], cos * f[1] - sin * f[2], sin * f[1] + cos * f[2]]).collect()
}

/// Row starts, columns, values, points, held and force, as raw numbers.
fn export(folder: &str, body: &Body<3>, matrix: &springfit_multigrid::BlockMatrix<3, 3>, force: &[f64]) {
    fs::create_dir_all(folder).unwrap();
    let write = |name: &str, bytes: Vec<u8>| fs::write(format!("{folder}/{name}"), bytes).unwrap();
    let pattern = matrix.pattern();
    let mut starts = vec![0_i32];
    let mut columns: Vec<i32> = Vec::new();
    for row in 0..pattern.rows() {
        columns.extend(pattern.row(row).iter().map(|c| *c as i32));
        starts.push(columns.len() as i32);
    }
    write("starts", starts.iter().flat_map(|x| x.to_le_bytes()).collect());
    write("columns", columns.iter().flat_map(|x| x.to_le_bytes()).collect());
    write("values", matrix.values().iter().flatten().flatten().flat_map(|x| x.to_le_bytes()).collect());
    write("points", body.points.iter().flat_map(|x| x.to_le_bytes()).collect());
    write("force", force.iter().flat_map(|x| x.to_le_bytes()).collect());
    write("held", body.is_held.iter().map(|h| u8::from(*h)).collect());
}
