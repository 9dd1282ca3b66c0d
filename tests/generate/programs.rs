//! Programs that call the generated functions for all cells and print what they return.

use super::case::{Case, Sample};
use std::fmt::Write;
use std::fs;
use std::ops::Range;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// What the functions say of one cell.
#[derive(Debug)]
pub struct Outcome {
    pub status: usize,
    pub constants: Vec<f64>,
    pub rests: Vec<f64>,
    pub energy: f64,
    pub forces: Vec<f64>,
}

/// Runs a command in the folder; none if the program is not there.
pub fn run(folder: &Path, program: &str, arguments: &[&str]) -> Option<Output> {
    let output = Command::new(program).args(arguments).current_dir(folder).output().ok()?;
    let message = String::from_utf8_lossy(&output.stderr);
    let first: Vec<&str> = message.lines().take(20).collect();
    assert!(output.status.success(), "{program}: {}", first.join("\n"));
    Some(output)
}

/// Reads a line of numbers for each cell: the status, constants, rests, energy, forces.
fn read(cases: &[Case], output: &Output) -> Vec<Outcome> {
    let text = String::from_utf8_lossy(&output.stdout);
    let mut lines = text.lines();
    let mut outcomes = Vec::new();
    for case in cases {
        let (m, size) = (case.springs.len(), case.element.nodes() * case.element.dimension());
        for _ in &case.samples {
            let line = lines.next().expect("a line for each cell");
            let numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
            assert_eq!(numbers.len(), 2 + 2 * m + size, "{}", case.prefix());
            outcomes.push(Outcome {
                status: numbers[0] as usize,
                constants: numbers[1..=m].to_vec(),
                rests: numbers[m + 1..=2 * m].to_vec(),
                energy: numbers[2 * m + 1],
                forces: numbers[2 * m + 2..].to_vec(),
            });
        }
    }
    outcomes
}

pub fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|x| word(*x)).collect::<Vec<_>>().join(", ")
}

fn word(number: f64) -> String {
    match number {
        _ if number.is_nan() => "NAN".into(),
        f64::INFINITY => "INFINITY".into(),
        _ => format!("{number:e}"),
    }
}

/// A C program of these functions in `real` numbers. Each case is a file of its own, because cases may have the same names.
fn c_program(cases: &[Case], language: &str, real: &str, folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    let (mut main, mut calls) = (String::new(), String::new());
    for (i, case) in cases.iter().enumerate() {
        let (m, size) = (case.springs.len(), case.element.nodes() * case.element.dimension());
        let (mut text, prefix) = (case.text(language).unwrap(), case.prefix());
        for kind in ["int", "float", "void"] {
            text = text.replace(&format!("\n{kind} {prefix}"), &format!("\nstatic {kind} {prefix}"));
        }
        let mut code = format!("#include <math.h>\n#include <stdio.h>\n{WORDS}\n{text}\n");
        write!(
            code,
            "static void cell(const {real} *x, const {real} *y, {real} lambda, {real} mu) {{\n\
             {real} constants[{m}], rests[{m}], forces[{size}];\n\
             for (int s = 0; s < {m}; ++s) constants[s] = rests[s] = 7;\n\
             for (int s = 0; s < {size}; ++s) forces[s] = 0;\n\
             const int status = {prefix}_constants(x, lambda, mu, constants, rests);\n\
             {real} energy = 0;\n\
             if (status == 0) {{ energy = {prefix}_energy(y, constants, rests); {prefix}_forces(y, constants, rests, forces); }}\n\
             printf(\"%d\", status);\n\
             for (int s = 0; s < {m}; ++s) printf(\" %.17g\", (double)constants[s]);\n\
             for (int s = 0; s < {m}; ++s) printf(\" %.17g\", (double)rests[s]);\n\
             printf(\" %.17g\", (double)energy);\n\
             for (int s = 0; s < {size}; ++s) printf(\" %.17g\", (double)forces[s]);\n\
             printf(\"\\n\");\n}}\nvoid case_{i}(void);\nvoid case_{i}(void) {{\n"
        )
        .unwrap();
        for Sample { x, deformed, moduli, .. } in &case.samples {
            writeln!(
                code,
                "{{ const {real} x[] = {{{}}}; const {real} y[] = {{{}}}; cell(x, y, {}, {}); }}",
                list(x),
                list(deformed),
                word(moduli[0]),
                word(moduli[1])
            )
            .unwrap();
        }
        code += "}\n";
        let name = format!("case_{i}.c");
        fs::write(folder.join(&name), code).unwrap();
        names.push(name);
        writeln!(main, "void case_{i}(void);").unwrap();
        writeln!(calls, "case_{i}();").unwrap();
    }
    fs::write(folder.join("main.c"), format!("{main}int main(void) {{\n{calls}return 0;\n}}\n")).unwrap();
    names.push("main.c".into());
    names
}

/// Nothing in C; the words of GLSL where they are defined.
const WORDS: &str = "#ifdef SINGLE\n#define in const\n#define inout\n#define sqrt sqrtf\n#define abs fabsf\n#endif";

/// Compiles the files of a C program, several at once, and runs it; none without a compiler.
fn compiled(folder: &Path, options: &[&str], names: &[String]) -> Option<Output> {
    let compile = |names: &[String]| {
        let arguments: Vec<&str> =
            options.iter().copied().chain(["-c"]).chain(names.iter().map(String::as_str)).collect();
        run(folder, "cc", &arguments).is_some()
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let parts = names.chunks(names.len().div_ceil(threads));
    let done = std::thread::scope(|scope| {
        let parts: Vec<_> = parts.map(|names| scope.spawn(move || compile(names))).collect();
        parts.into_iter().all(|part| part.join().expect("the code compiles"))
    });
    let objects: Vec<String> = names.iter().map(|name| name.replace(".c", ".o")).collect();
    let arguments: Vec<&str> =
        ["-o", "program"].into_iter().chain(objects.iter().map(String::as_str)).chain(["-lm"]).collect();
    done.then(|| run(folder, "cc", &arguments)).flatten()?;
    run(folder, "./program", &[])
}

/// C; none without a compiler.
pub fn c(cases: &[Case], options: &[&str]) -> Option<Vec<Outcome>> {
    let folder = TempDir::new().unwrap();
    let names = c_program(cases, "c", "double", folder.path());
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O0"];
    let options: Vec<&str> = strict.iter().chain(options).copied().collect();
    Some(read(cases, &compiled(folder.path(), &options, &names)?))
}

/// GLSL as C in single precision.
pub fn single(cases: &[Case]) -> Option<Vec<Outcome>> {
    let folder = TempDir::new().unwrap();
    let names = c_program(cases, "glsl", "float", folder.path());
    let options = ["-std=gnu99", "-w", "-DSINGLE", "-fsingle-precision-constant"];
    Some(read(cases, &compiled(folder.path(), &options, &names)?))
}

/// Rust, by the compiler that compiles the tests.
pub fn rust(cases: &[Case]) -> Vec<Outcome> {
    let folder = TempDir::new().unwrap();
    let mut main = String::from("#![deny(warnings)]\n");
    let mut calls = String::new();
    for (i, case) in cases.iter().enumerate() {
        let (m, size) = (case.springs.len(), case.element.nodes() * case.element.dimension());
        let prefix = case.prefix();
        fs::write(folder.path().join(format!("case_{i}.rs")), case.text("rust").unwrap()).unwrap();
        writeln!(main, "#[allow(dead_code)] mod case_{i};").unwrap();
        for Sample { x, deformed, moduli: [lambda, mu], .. } in &case.samples {
            writeln!(
                calls,
                "{{ let (x, y) = ([{}], [{}]);\n\
                 let (mut constants, mut rests, mut forces) = ([7.0; {m}], [7.0; {m}], [0.0; {size}]);\n\
                 match case_{i}::{prefix}_constants(&x, {}, {}, &mut constants, &mut rests) {{\n\
                 Ok(()) => print!(\"0\"), Err(status) => print!(\"{{status}}\") }}\n\
                 let energy = case_{i}::{prefix}_energy(&y, &constants, &rests);\n\
                 case_{i}::{prefix}_forces(&y, &constants, &rests, &mut forces);\n\
                 let all = constants.iter().chain(&rests).chain(std::iter::once(&energy)).chain(&forces);\n\
                 all.for_each(|value| print!(\" {{value:e}}\"));\nprintln!(); }}",
                list(x),
                list(deformed),
                word(*lambda),
                word(*mu)
            )
            .unwrap();
        }
    }
    fs::write(folder.path().join("main.rs"), format!("{main}fn main() {{\n{calls}}}\n")).unwrap();
    let rustc = std::env::var("RUSTC").unwrap_or("rustc".into());
    run(folder.path(), &rustc, &["--edition", "2021", "-o", "program", "main.rs"]).expect("Rust compiles the tests");
    read(cases, &run(folder.path(), "./program", &[]).expect("it was compiled"))
}

/// Python; none without it.
pub fn python(cases: &[Case]) -> Option<Vec<Outcome>> {
    let folder = TempDir::new().unwrap();
    let mut main = String::from("from math import nan as NAN, inf as INFINITY\n");
    for (i, case) in cases.iter().enumerate() {
        let prefix = case.prefix();
        let numbers = 2 * case.springs.len() + 1 + case.element.nodes() * case.element.dimension();
        fs::write(folder.path().join(format!("case_{i}.py")), case.text("python").unwrap()).unwrap();
        writeln!(main, "import case_{i}").unwrap();
        for Sample { x, deformed, moduli: [lambda, mu], .. } in &case.samples {
            writeln!(
                main,
                "y = [{}]\ntry:\n constants, rests = case_{i}.{prefix}_constants([{}], {}, {})\n \
                 energy = case_{i}.{prefix}_energy(y, constants, rests)\n \
                 forces = case_{i}.{prefix}_forces(y, constants, rests)\n \
                 print(0, *constants, *rests, energy, *forces)\n\
                 except case_{i}.SpringError as error:\n print(error.status, *[7.0] * {numbers})",
                list(deformed),
                list(x),
                word(*lambda),
                word(*mu)
            )
            .unwrap();
        }
    }
    fs::write(folder.path().join("main.py"), main).unwrap();
    Some(read(cases, &run(folder.path(), "python3", &["main.py"])?))
}

/// JavaScript; none without Node.
pub fn javascript(cases: &[Case]) -> Option<Vec<Outcome>> {
    let folder = TempDir::new().unwrap();
    let mut main = String::from("const [NAN, INFINITY] = [NaN, Infinity];\n");
    for (i, case) in cases.iter().enumerate() {
        let prefix = case.prefix();
        fs::write(folder.path().join(format!("case_{i}.mjs")), case.text("javascript").unwrap()).unwrap();
        writeln!(main, "import * as case_{i} from \"./case_{i}.mjs\";").unwrap();
        for Sample { x, deformed, moduli: [lambda, mu], .. } in &case.samples {
            writeln!(
                main,
                "{{ const y = [{}];\nconst [constants, rests] = case_{i}.{prefix}_constants([{}], {}, {});\n\
                 const energy = case_{i}.{prefix}_energy(y, constants, rests);\n\
                 const forces = case_{i}.{prefix}_forces(y, constants, rests);\n\
                 console.log([0, ...constants, ...rests, energy, ...forces].join(\" \")); }}",
                list(deformed),
                list(x),
                word(*lambda),
                word(*mu)
            )
            .unwrap();
        }
    }
    fs::write(folder.path().join("main.mjs"), main).unwrap();
    Some(read(cases, &run(folder.path(), "node", &["main.mjs"])?))
}

/// Programs that check the syntax of a language and are not needed to build springfit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tool {
    /// The parser and validator of WGSL, in `crates/shaders`.
    Shaders,
    /// The reference compiler of GLSL.
    Glslang,
    /// A C++ compiler, with the words of CUDA defined away; no compiler of CUDA is asked for.
    Cuda,
}

impl Tool {
    /// Checks the texts of all cases that the language has room for, of lengths in bytes that are asked for; their number, or none without the tool.
    pub fn check(self, cases: &[Case], lengths: Range<usize>) -> Option<usize> {
        let folder = TempDir::new().unwrap();
        let (language, program) = match self {
            Tool::Shaders => ("wgsl", "springfit-shaders"),
            Tool::Glslang => ("glsl", "glslangValidator"),
            Tool::Cuda => ("cuda", "c++"),
        };
        let texts = cases.iter().filter_map(|case| case.text(language)).filter(|text| lengths.contains(&text.len()));
        let texts: Vec<String> = texts.collect();
        let whole = |i: usize, text: &String| match self {
            Tool::Shaders => (format!("{i}_code.wgsl"), text.clone()),
            Tool::Glslang => {
                let main = "layout(local_size_x = 1) in;\nvoid main() {}\n";
                (format!("{i}_code.comp"), format!("#version 450\n{text}\n{main}"))
            }
            Tool::Cuda => (format!("{i}_code.h"), text.clone()),
        };
        let files: Vec<(String, String)> = texts.iter().enumerate().map(|(i, text)| whole(i, text)).collect();
        files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).unwrap());
        let names = files.into_iter().map(|(name, _)| name);
        let strict = ["-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-Wno-unused"].map(String::from);
        let arguments: Vec<String> = match self {
            // One file for all: a C++ compiler reads the system's headers anew for each, which takes longer than the code. Cases may have the
            // same names.
            Tool::Cuda => {
                let mut all = String::from("#include <math.h>\n#define __device__\n#define __forceinline__ inline\n");
                names.enumerate().for_each(|(i, name)| {
                    writeln!(all, "namespace case_{i} {{\n#include \"{name}\"\n}}").unwrap();
                });
                fs::write(folder.path().join("code.cc"), all).unwrap();
                strict.into_iter().chain(["code.cc".into()]).collect()
            }
            _ => names.collect(),
        };
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        run(folder.path(), program, &arguments)?;
        Some(texts.len())
    }
}
