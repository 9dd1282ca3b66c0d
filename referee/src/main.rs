//! The spectral fit beside Clarabel's semidefinite cone, in one run on one thread: agreement and time per element type.
//!
//! `cargo run --release -p springfit-referee`; exit code 1 if the two optima differ by more than 1e-6. Needs a BLAS with
//! LAPACK: `apt-get install libopenblas-dev`.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nalgebra::{DMatrix, DVector};
use springfit::element::{Element, SHIPPED};
use springfit::fit::{Fit, MotionWeight, Objective, Search, Solver, fit_cells};
use springfit::material::{Material, Moduli};
use springfit::springs::Springs;
use springfit::stiffness::Geometry;
use springfit::study::random_shapes;
use std::process::ExitCode;
use std::time::Instant;

#[link(name = "openblas")]
unsafe extern "C" {}

/// R and the g_s on an orthonormal basis of the deformations, from the eigenvectors of R.
fn reduced(element: &Element, springs: &Springs, x: &[f64], moduli: Moduli) -> (DMatrix<f64>, Vec<DVector<f64>>) {
    let mut geometry = Geometry::new(&element.tabulation);
    geometry.set(&element.tabulation, x).expect("the shape is valid");
    let mut rows = Vec::new();
    springs.gradients(x, &geometry, &mut rows);
    let eigen = geometry.stiffness(moduli).symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let kept: Vec<usize> = (0..x.len()).filter(|&i| eigen.eigenvalues[i] > 1e-9 * largest).collect();
    let basis = eigen.eigenvectors.select_columns(&kept);
    let r = DMatrix::from_diagonal(&DVector::from_fn(kept.len(), |i, _| eigen.eigenvalues[kept[i]]));
    (r, rows.chunks_exact(x.len()).map(|g| basis.tr_mul(&DVector::from_column_slice(g))).collect())
}

/// `min t` with `tI ± (R − Σ k_s g_s g_sᵀ) ⪰ 0`, R scaled to one; the optimum in the units of R.
fn conic(r: &DMatrix<f64>, g: &[DVector<f64>], nonnegative: bool) -> Option<f64> {
    let (p, m) = (r.nrows(), g.len());
    let size = r.trace() / p as f64;
    // The upper triangle by columns, off-diagonal entries times √2.
    let triangle: Vec<(usize, usize, f64)> =
        (0..p).flat_map(|j| (0..=j).map(move |i| (i, j, if i == j { 1.0 } else { 2f64.sqrt() }))).collect();
    let (mut rows, mut columns, mut values, mut b) = (vec![], vec![], vec![], vec![]);
    for sign in [1.0, -1.0] {
        for &(i, j, scale) in &triangle {
            let row = b.len();
            // s = b − A (k, t) = t I ∓ R ± Σ k g gᵀ
            b.push(-sign * scale * r[(i, j)] / size);
            for (s, g) in g.iter().enumerate() {
                rows.push(row);
                columns.push(s);
                values.push(-sign * scale * g[i] * g[j] / g.norm_squared());
            }
            if i == j {
                rows.push(row);
                columns.push(m);
                values.push(-1.0);
            }
        }
    }
    let mut cones = vec![SupportedConeT::PSDTriangleConeT(p), SupportedConeT::PSDTriangleConeT(p)];
    if nonnegative {
        for s in 0..m {
            rows.push(b.len());
            columns.push(s);
            values.push(-1.0);
            b.push(0.0);
        }
        cones.push(SupportedConeT::NonnegativeConeT(m));
    }
    let a = CscMatrix::new_from_triplets(b.len(), m + 1, rows, columns, values);
    let mut q = vec![0.0; m + 1];
    q[m] = 1.0;
    let settings = DefaultSettings { verbose: false, ..Default::default() };
    let mut solver = DefaultSolver::new(&CscMatrix::zeros((m + 1, m + 1)), &q, &a, &b, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    solved.then(|| size * solver.solution.x[m])
}

fn main() -> ExitCode {
    let count: usize = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(200);
    // Before the first use of the pool, which reads it once; no other thread runs yet.
    unsafe { std::env::set_var("RAYON_NUM_THREADS", "1") };
    println!("{count} random elements each, one thread");
    println!(
        "{:8} {:>7} {:6} {:>12} {:>12} {:>7} {:>14} {:>12} {:>20}",
        "element",
        "springs",
        "k >= 0",
        "native us",
        "Clarabel us",
        "ratio",
        "difference",
        "largest gap",
        "Nelder-Mead above"
    );
    let mut agree = true;
    for shipped in SHIPPED {
        let element = Element::load(shipped.name).expect("it is shipped");
        // A rod is its spring; beyond the linear elements the general cone takes minutes.
        if element.dimension() == 1 || element.nodes() > element.cell.corners().len() {
            continue;
        }
        let material = Material::for_body(element.dimension(), 1e4, 0.3, None, None).expect("it is valid");
        let moduli = material.moduli();
        let every: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
        for names in [None, Some(&every[..])] {
            let springs = Springs::select(&element, names).expect("the groups are its own");
            for nonnegative in [false, true] {
                agree &= compare(&element, &springs, moduli, nonnegative, count);
            }
        }
    }
    if agree { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Prints one row; false where the two disagree, or something beats the certified bound.
fn compare(element: &Element, springs: &Springs, moduli: Moduli, nonnegative: bool, count: usize) -> bool {
    let x = random_shapes(element, count, 2026).expect("few shapes tangle");
    let size = element.positions.len();
    let cells: Vec<usize> = (0..count * element.nodes()).collect();
    let fit = Fit { nonnegative, ..Fit::new(Objective::Spectral(MotionWeight::None)) };
    let start = Instant::now();
    let fits = fit_cells(element, springs, &x, &cells, moduli, &fit, &mut |_| {}).expect("every shape is valid");
    let native = start.elapsed().as_secs_f64() / count as f64;
    let gap = fits.certificates.iter().map(|c| c.gap()).fold(0.0, f64::max);
    let (mut seconds, mut difference, mut solved) = (0.0, 0.0f64, 0);
    for (x, certificate) in x.chunks_exact(size).zip(&fits.certificates) {
        let (r, g) = reduced(element, springs, x, moduli);
        let start = Instant::now();
        let optimum = conic(&r, &g, nonnegative);
        seconds += start.elapsed().as_secs_f64();
        if let Some(t) = optimum {
            difference = difference.max((t / certificate.value - 1.0).abs());
            solved += 1;
        }
    }
    let conic = seconds / count as f64;
    // What a general optimiser reaches, over the certified bound.
    let few = 5.min(count);
    let solver = Solver::General { method: Search::NelderMead, iterations: 2000, topology: None };
    let search = Fit { solver, ..fit };
    let part = &cells[..few * element.nodes()];
    let found = fit_cells(element, springs, &x, part, moduli, &search, &mut |_| {}).expect("every shape is valid");
    let (mut least, mut mean) = (f64::INFINITY, 0.0);
    for (i, x) in x.chunks_exact(size).take(few).enumerate() {
        let (mut e, g) = reduced(element, springs, x, moduli);
        let k = &found.constants[i * springs.len()..(i + 1) * springs.len()];
        g.iter().zip(k).for_each(|(g, k)| e -= *k * g * g.transpose());
        let above = e.symmetric_eigenvalues().amax() / fits.certificates[i].bound - 1.0;
        least = least.min(above);
        mean += above / few as f64;
    }
    println!(
        "{:8} {:7} {:6} {:12.2} {:12.1} {:7.0} {:14.1e} {:12.1e} {:9.1e} to mean {:.1e}",
        element.name,
        springs.len(),
        nonnegative,
        1e6 * native,
        1e6 * conic,
        conic / native,
        difference,
        gap,
        least,
        mean
    );
    if solved < count {
        println!("  Clarabel reported no solution for {} of {count}", count - solved);
    }
    difference <= 1e-6 && gap <= 1e-8 && least > -1e-9
}
