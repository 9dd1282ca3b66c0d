//! The time per cell of generated C beside the kernels of the library, on one core: `cargo bench --bench generate`.
//!
//! The C is compiled with `-O3 -march=native` and called cell by cell, as a program that remeshes would call it. The
//! kernels fit the same cells, several at once in the lanes of the processor.

use springfit_element::element::Element;
use springfit_element::material::Material;
use springfit_element::springs::Springs;
use springfit_fit::fit::{CellFits, ExactFit, Fit, Objective, fit_cells, fit_exact, published};
use springfit_generate::generate::{Program, Recipe, language};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// The number of cells, which fit into the cache, and how often they are computed.
const CELLS: usize = 1024;
const RUNS: usize = 20;

/// Random numbers in [-1, 1].
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Separate cells near the reference cell, `[cells × nodes × dimension]`.
fn cells(element: &Element) -> Vec<f64> {
    let mut state = 1;
    let place = |x: &f64| x + 0.05 * random(&mut state);
    std::iter::repeat_n(&element.positions, CELLS).flatten().map(place).collect()
}

/// The nanoseconds per cell of the kernels, and the sum of all constants.
fn kernels(element: &Element, recipe: Recipe, x: &[f64], material: Material) -> (f64, f64) {
    let connectivity: Vec<usize> = (0..CELLS * element.nodes()).collect();
    let springs = Springs::select(element, None).expect("no group is named");
    let fitted = |fits: Option<CellFits>| {
        let fits = match (recipe, fits) {
            (Recipe::Exact(volume), _) => {
                let fit = ExactFit { volume, ..ExactFit::default() };
                fit_exact(element, x, &connectivity, material, &fit, &mut |_| {})
            }
            (Recipe::Frobenius(weight), Some(mut fits)) => {
                let fit = Fit::new(Objective::Frobenius(weight));
                fits.refit(element, x, &connectivity, material.moduli(), &fit, &mut |_| {}).map(|()| fits)
            }
            (Recipe::Frobenius(weight), None) => {
                let fit = Fit::new(Objective::Frobenius(weight));
                fit_cells(element, &springs, x, &connectivity, material.moduli(), &fit, &mut |_| {})
            }
            (Recipe::Published(method), _) => published::fit(method, element, &springs, x, &connectivity, material),
        };
        fits.expect("cells are upright")
    };
    let mut best = f64::MAX;
    let mut fits = fitted(None);
    for _ in 0..RUNS {
        let start = Instant::now();
        fits = fitted(Some(fits));
        best = best.min(start.elapsed().as_secs_f64());
    }
    (1e9 * best / CELLS as f64, fits.constants.iter().sum())
}

/// The same of the generated C: its program prints both. None without a compiler.
fn generated(element: &Element, recipe: Recipe, x: &[f64], material: Material) -> Option<(f64, f64)> {
    let program = Program::new(element, None, recipe).expect("it has a direct solution");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let header = program.print(language("c").expect("it is one")).expect("C has room");
    let (prefix, size, moduli) = (&program.prefix, element.nodes() * element.dimension(), material.moduli());
    let springs = header.split(" constants[").nth(1)?.split(']').next()?.to_string();
    let main = format!(
        "#define _POSIX_C_SOURCE 199309L\n#include <stdio.h>\n#include <time.h>\n#include \"cell.h\"\n\
         static double x[{CELLS}][{size}], k[{CELLS}][{springs}], rests[{springs}];\n\
         int main(int count, char **names) {{\n\
         FILE *file = fopen(names[count - 1], \"rb\");\n\
         if (!file || fread(x, sizeof x, 1, file) != 1) return 1;\n\
         double best = 1e9, sum = 0;\n\
         for (int run = 0; run < {RUNS}; ++run) {{\n\
         struct timespec a, b;\n\
         clock_gettime(CLOCK_MONOTONIC, &a);\n\
         for (int c = 0; c < {CELLS}; ++c) if ({prefix}_constants(x[c], {:e}, {:e}, k[c], rests)) return 1;\n\
         clock_gettime(CLOCK_MONOTONIC, &b);\n\
         const double seconds = (double)(b.tv_sec - a.tv_sec) + 1e-9 * (double)(b.tv_nsec - a.tv_nsec);\n\
         if (seconds < best) best = seconds;\n}}\n\
         for (int c = 0; c < {CELLS}; ++c) for (int s = 0; s < {springs}; ++s) sum += k[c][s];\n\
         printf(\"%.17g %.17g\\n\", 1e9 * best / {CELLS}, sum);\nreturn 0;\n}}\n",
        moduli.lambda, moduli.mu
    );
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("room for a file");
    write("cell.h", header.as_bytes());
    write("main.c", main.as_bytes());
    write("x.f64", &x.iter().flat_map(|x| x.to_ne_bytes()).collect::<Vec<u8>>());
    let run =
        |name: &Path, arguments: &[&str]| Command::new(name).args(arguments).current_dir(folder.path()).output().ok();
    let compiled = run(Path::new("cc"), &["-std=c99", "-O3", "-march=native", "main.c", "-o", "main", "-lm"])?;
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let printed = run(&folder.path().join("main"), &["x.f64"])?;
    let text = String::from_utf8_lossy(&printed.stdout);
    let mut numbers = text.split_whitespace().map(|word| word.parse::<f64>().expect("numbers are printed"));
    Some((numbers.next()?, numbers.next()?))
}

fn main() {
    // `cargo bench --bench generate -- tet10` times that element alone.
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let names = if chosen.is_empty() { vec!["tet4".into(), "hex8".into()] } else { chosen };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    println!("on one core, ns per cell; the sums of all constants agree to the last column");
    println!("{:8} {:20} {:>10} {:>12} {:>8}", "element", "objective", "kernels", "C", "ratio");
    for name in names {
        let element = Element::load(&name).expect("it is an element");
        let material = Material::for_body(element.dimension(), 1e4, 0.3, None, None).expect("it is valid");
        let x = cells(&element);
        for objective in ["exact", "offdiag", "frobenius", "modal"] {
            let recipe = Recipe::named(objective, None, None).expect("it has a direct solution");
            let (ours, sum) = one.install(|| kernels(&element, recipe, &x, material));
            match generated(&element, recipe, &x, material) {
                Some((c, other)) => {
                    let difference = ((sum - other) / sum).abs();
                    println!("{name:8} {objective:20} {ours:10.0} {c:12.0} {:8.2} {difference:8.0e}", c / ours);
                }
                None => println!("{name:8} {objective:20} {ours:10.0}   no C compiler"),
            }
        }
    }
}
