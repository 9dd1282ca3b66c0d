//! A branch whose stress relaxes: the generated steps against the memory of the program, on random shapes.

use super::programs::{list, run};
use crate::shapes::{Random, distorted};
use springfit_bodies::dynamics::{BranchForm, LargeMemory, Memory};
use springfit_bodies::model::MaterialPoints;
use springfit_element::element::Element;
use springfit_element::material::{Material, Relaxation, RelaxationTerm, State};
use springfit_fit::fit::ShearSprings;
use springfit_foundation::error::ErrorKind;
use springfit_generate::generate::{Program, Recipe, language};
use springfit_mesh::mesh::{CellBlock, Mesh};
use std::fmt::Write;
use std::fs;
use std::sync::Arc;
use tempfile::TempDir;

const ELEMENTS: [&str; 6] = ["tet4", "hex8", "tet10", "tri3", "quad4", "hex20"];
const STEPS: usize = 3;
/// The step and the relaxation time, s.
const STEP: f64 = 0.3;
const TIME: f64 = 0.7;
const SHARE: f64 = 0.6;

/// One cell at rest, the shapes at the ends of its steps, the shear modulus of its branch, and the forces of the program there.
struct Steps {
    name: &'static str,
    x: Vec<f64>,
    shapes: Vec<Vec<f64>>,
    modulus: f64,
    forces: Vec<f64>,
}

impl Steps {
    fn of(name: &'static str, random: &mut Random) -> Steps {
        let element = Arc::new(Element::load(name).unwrap());
        let (n, d) = (element.nodes(), element.dimension());
        let x = distorted(&element, random);
        let blocks = vec![CellBlock { element: element.clone(), connectivity: (0..n).collect() }];
        let mesh = Mesh::of_cells(d, x.clone(), blocks);
        let state = if d == 3 { State::Solid } else { State::PlaneStrain { thickness: 0.5 } };
        let material = Material::new(1e4, 0.3, state).unwrap();
        let points = MaterialPoints::of(&mesh, &material.into(), ShearSprings::Cells).unwrap();
        let term = RelaxationTerm { shear: SHARE, bulk: 0.0, time: TIME, yield_stress: None };
        let series = Relaxation::new(vec![term]).unwrap();
        let mut memory = Memory::Large(Box::new(LargeMemory::new(points, BranchForm::Edges, &x, &series).unwrap()));
        assert!(memory.reset(&vec![0.0; x.len()]));
        let (mut shapes, mut forces) = (Vec::new(), Vec::new());
        while shapes.len() < STEPS {
            let grown = 1.0 + 0.2 * random.next();
            let shape: Vec<f64> = x.iter().map(|x| grown * x + 0.04 * random.next()).collect();
            let u: Vec<f64> = shape.iter().zip(&x).map(|(shape, x)| shape - x).collect();
            memory.prepare(STEP);
            let mut force = vec![0.0; x.len()];
            if memory.add(&u, &mut force, None).is_some() {
                memory.advance(&u);
                shapes.push(shape);
                // Those of the program are gradients of an energy.
                forces.extend(force.iter().map(|f| -f));
            }
        }
        Steps { name, x, shapes, modulus: SHARE * material.moduli().mu, forces }
    }

    fn program(&self) -> Program {
        let element = Element::load(self.name).unwrap();
        let recipe = Recipe::named("exact", None, None).unwrap();
        Program::new(&element, None, recipe).unwrap().with_branch(&element, recipe).unwrap()
    }

    /// The numbers of nodes times directions, of points and of pairs.
    fn sizes(&self) -> [usize; 3] {
        let element = Element::load(self.name).unwrap();
        let n = element.nodes();
        [self.x.len(), element.tabulation.points(), n * (n - 1) / 2]
    }
}

/// `mean`, `left` and `taken`.
fn weights() -> [f64; 3] {
    let left = f64::exp(-STEP / TIME);
    let mean = (1.0 - left) * TIME / STEP;
    [mean, left, mean * (1.0 - left)]
}

fn all() -> Vec<Steps> {
    let mut random = Random(55);
    ELEMENTS.map(|name| Steps::of(name, &mut random)).into()
}

fn compare(all: &[Steps], text: &[u8]) {
    let text = String::from_utf8_lossy(text);
    let mut lines = text.lines();
    for steps in all {
        let line = lines.next().expect("a line for each element");
        let found: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
        assert_eq!(found.len(), steps.forces.len(), "{}", steps.name);
        let size = steps.forces.iter().fold(0.0f64, |a, f| a.max(f.abs()));
        let apart = found.iter().zip(&steps.forces).fold(0.0f64, |a, (x, y)| a.max((x - y).abs())) / size;
        println!("{}: {apart:.1e}", steps.name);
        assert!(apart < 1e-12, "{}: {apart:e}", steps.name);
    }
}

#[test]
fn generated_branches_in_c_relax_as_the_program() {
    let (all, folder) = (all(), TempDir::new().unwrap());
    let [mean, left, taken] = weights();
    let (mut first, mut calls) = (String::from("#include <stdio.h>\n"), String::new());
    for steps in &all {
        let program = steps.program();
        let (prefix, [size, points, pairs]) = (&program.prefix, steps.sizes());
        fs::write(folder.path().join(format!("{}.h", steps.name)), program.print(language("c").unwrap()).unwrap())
            .unwrap();
        writeln!(first, "#include \"{}.h\"", steps.name).unwrap();
        writeln!(
            calls,
            "{{ const double x[] = {{{}}}; double sizes[{points}], branch[{pairs}], relaxed[{pairs}], forces[{size}];\n\
             if ({prefix}_branch(x, {:e}, {mean:e}, sizes, branch)) return 1;",
            list(&steps.x),
            steps.modulus
        )
        .unwrap();
        for shape in &steps.shapes {
            writeln!(
                calls,
                "{{ const double x[] = {{{}}};\nif ({prefix}_relax(x, sizes, branch, {:e}, {mean:e}, {left:e}, {taken:e}, forces, relaxed)) return 1;\n\
                 for (int i = 0; i < {size}; ++i) printf(\"%.17g \", forces[i]);\nfor (int i = 0; i < {pairs}; ++i) branch[i] = relaxed[i]; }}",
                list(shape),
                steps.modulus
            )
            .unwrap();
        }
        calls += "printf(\"\\n\"); }\n";
    }
    fs::write(folder.path().join("main.c"), format!("{first}int main(void) {{\n{calls}return 0;\n}}\n")).unwrap();
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O0", "main.c", "-o", "program", "-lm"];
    run(folder.path(), "cc", &strict).expect("the tests need a C compiler");
    compare(&all, &run(folder.path(), "./program", &[]).unwrap().stdout);
}

#[test]
fn generated_branches_in_rust_relax_as_the_program() {
    let (all, folder) = (all(), TempDir::new().unwrap());
    let [mean, left, taken] = weights();
    let (mut first, mut calls) = (String::from("#![deny(warnings)]\n"), String::new());
    for steps in &all {
        let program = steps.program();
        let (prefix, name, [size, points, pairs]) = (&program.prefix, steps.name, steps.sizes());
        fs::write(folder.path().join(format!("{name}.rs")), program.print(language("rust").unwrap()).unwrap()).unwrap();
        writeln!(first, "#[allow(dead_code)] mod {name};").unwrap();
        writeln!(
            calls,
            "{{ let (mut sizes, mut branch) = ([0.0; {points}], [0.0; {pairs}]);\n\
             {name}::{prefix}_branch(&[{}], {:e}, {mean:e}, &mut sizes, &mut branch).unwrap();",
            list(&steps.x),
            steps.modulus
        )
        .unwrap();
        for shape in &steps.shapes {
            writeln!(
                calls,
                "let (mut forces, mut relaxed) = ([0.0; {size}], [0.0; {pairs}]);\n\
                 {name}::{prefix}_relax(&[{}], &sizes, &branch, {:e}, {mean:e}, {left:e}, {taken:e}, &mut forces, &mut relaxed).unwrap();\n\
                 forces.iter().for_each(|f| print!(\"{{f:e}} \"));\nbranch = relaxed;",
                list(shape),
                steps.modulus
            )
            .unwrap();
        }
        calls += "let _ = branch;\nprintln!(); }\n";
    }
    fs::write(folder.path().join("main.rs"), format!("{first}fn main() {{\n{calls}}}\n")).unwrap();
    let rustc = std::env::var("RUSTC").unwrap_or("rustc".into());
    run(folder.path(), &rustc, &["--edition", "2021", "-o", "program", "main.rs"]).expect("Rust compiles the tests");
    compare(&all, &run(folder.path(), "./program", &[]).unwrap().stdout);
}

#[test]
fn generated_branches_in_scripts_relax_as_the_program() {
    let (all, folder) = (all(), TempDir::new().unwrap());
    let [mean, left, taken] = weights();
    let [mut python, mut script] = [const { String::new() }; 2];
    for steps in &all {
        let program = steps.program();
        let (prefix, name, mu) = (&program.prefix, steps.name, steps.modulus);
        for (kind, ending) in [("python", "py"), ("javascript", "mjs")] {
            let path = folder.path().join(format!("{name}.{ending}"));
            fs::write(path, program.print(language(kind).unwrap()).unwrap()).unwrap();
        }
        let x = list(&steps.x);
        writeln!(python, "import {name}\nsizes, branch = {name}.{prefix}_branch([{x}], {mu:e}, {mean:e})\nall = []")
            .unwrap();
        writeln!(
            script,
            "{{ const cell = await import(\"./{name}.mjs\");\nlet [sizes, branch] = cell.{prefix}_branch([{x}], {mu:e}, {mean:e});\nconst all = [];"
        )
        .unwrap();
        for shape in &steps.shapes {
            let arguments = format!("[{}], sizes, branch, {mu:e}, {mean:e}, {left:e}, {taken:e}", list(shape));
            writeln!(python, "forces, branch = {name}.{prefix}_relax({arguments})\nall += forces").unwrap();
            writeln!(script, "{{ const [forces, relaxed] = cell.{prefix}_relax({arguments});\nall.push(...forces); branch = relaxed; }}").unwrap();
        }
        writeln!(python, "print(*all)").unwrap();
        writeln!(script, "console.log(all.join(\" \")); }}").unwrap();
    }
    for (name, file, code) in [("python3", "main.py", python), ("node", "main.mjs", script)] {
        fs::write(folder.path().join(file), code).unwrap();
        match run(folder.path(), name, &[file]) {
            Some(output) => compare(&all, &output.stdout),
            None => println!("not run: there is no {name}"),
        }
    }
}

/// A cell that is turned inside out has a status and leaves the results alone; every language writes it; a fit has no branch.
#[test]
fn branches_have_their_limits() {
    for steps in all() {
        let program = steps.program();
        for name in ["c", "cuda", "rust", "python", "javascript", "wgsl", "glsl", "latex"] {
            let text = program.print(language(name).unwrap());
            assert!(
                text.unwrap().contains(&if name == "latex" {
                    "relax".into()
                } else {
                    format!("{}_relax", program.prefix)
                }),
                "{name}"
            );
        }
    }
    let element = Element::load("tet4").unwrap();
    let fit = Recipe::named("offdiag", None, None).unwrap();
    let error = Program::new(&element, None, fit).unwrap().with_branch(&element, fit).unwrap_err();
    assert!(error.kind() == ErrorKind::Unsupported && error.to_string().contains("\"exact\""), "{error}");
}
