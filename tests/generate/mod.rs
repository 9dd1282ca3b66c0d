//! Generated code is compiled and run, and compared with the library: constants, rest measures, energies and forces of random
//! cells with random moduli, for every shipped element and objective.

mod branch;
mod case;
mod example;
mod programs;
mod refusals;
mod text;

use case::{Case, every};
use programs::{Outcome, Tool, c, javascript, python, rust, single};

/// The relative difference that rounding leaves. Where the condition of the normal equations is so large that it makes more of
/// the rounding errors of the two sides, that is allowed.
const ROUNDING: f64 = 1e-12;

/// Compares the outcomes of all cells, in the order of [`Case::samples`], and returns the largest difference.
fn compare(cases: &[Case], outcomes: &[Outcome], tolerance: f64) -> f64 {
    let mut outcomes = outcomes.iter();
    let mut worst: f64 = 0.0;
    for case in cases {
        for sample in &case.samples {
            let found = outcomes.next().expect("every cell has an outcome");
            assert_eq!(found.status, 0, "{}", case.prefix());
            let size = |values: &[f64]| values.iter().fold(f64::MIN_POSITIVE, |a, b| a.max(b.abs()));
            let numbers = [
                ("constants", &found.constants, &sample.constants),
                ("rests", &found.rests, &sample.rests),
                ("forces", &found.forces, &sample.forces),
            ];
            for (what, found, expected) in numbers {
                assert_eq!(found.len(), expected.len(), "{} {what}", case.prefix());
                // Constants on contents have another unit.
                for range in case.ranges(expected.len()) {
                    let size = size(&expected[range.clone()]);
                    for s in range {
                        let error = (found[s] - expected[s]).abs() / size;
                        worst = worst.max(error);
                        let is_close = error <= tolerance || error <= case.rounding(sample);
                        assert!(is_close, "{} {what} {s}: {} {}", case.prefix(), found[s], expected[s]);
                    }
                }
            }
            // Energies of springs of both signs cancel.
            let error = (found.energy - sample.energy).abs() / sample.energies;
            worst = worst.max(error);
            let is_close = error <= tolerance || error <= case.rounding(sample);
            assert!(is_close, "{} energy: {} {}", case.prefix(), found.energy, sample.energy);
        }
    }
    assert!(outcomes.next().is_none());
    worst
}

/// Whether the code of a case is short. That of many springs has loops; that of few is a straight line, for which a compiler takes long.
fn is_short(case: &Case) -> bool {
    case.element.nodes() <= 4 || case.springs.len() > 100
}

fn c_has_the_numbers(wanted: fn(&Case) -> bool, least: usize) {
    let cases = every(wanted);
    assert!(cases.len() > least, "{}", cases.len());
    let worst = compare(&cases, &c(&cases, &[]).expect("the tests need a C compiler"), ROUNDING);
    println!("{} functions in C, largest relative difference {worst:.1e}", cases.len());
}

#[test]
fn c_has_the_numbers_of_the_library() {
    c_has_the_numbers(|case| is_short(case) || case.element.nodes() == 8, 80);
}

#[test]
#[ignore = "takes a minute; .ci/long has it"]
fn c_of_every_element_has_the_numbers_of_the_library() {
    c_has_the_numbers(|_| true, 160);
}

#[test]
fn rust_has_the_numbers_of_the_library() {
    let cases = every(is_short);
    compare(&cases, &rust(&cases), ROUNDING);
}

#[test]
#[ignore = "takes a minute; .ci/long has it"]
fn rust_of_longer_code_has_the_numbers_of_the_library() {
    let cases = every(|case| case.element.nodes() <= 6 && !is_short(case));
    compare(&cases, &rust(&cases), ROUNDING);
}

#[test]
fn python_has_the_numbers_of_the_library() {
    let cases = every(|case| case.springs.len() < 100);
    let Some(found) = python(&cases) else { return println!("not run: there is no python3") };
    compare(&cases, &found, ROUNDING);
}

#[test]
fn javascript_has_the_numbers_of_the_library() {
    let cases = every(|case| case.springs.len() < 100);
    let Some(found) = javascript(&cases) else { return println!("not run: there is no node") };
    compare(&cases, &found, ROUNDING);
}

/// GLSL without tables is C with other words, and compiles as such. Single precision leaves seven digits less the condition.
#[test]
fn single_precision_has_the_digits_that_it_can_have() {
    let cases = every(|case| case.element.nodes() <= 4 && !case.is_mixed());
    let worst = compare(&cases, &single(&cases).expect("the tests need a C compiler"), 2e-3);
    assert!(worst > 1e-9, "these numbers are not of single precision");
}

/// A cell that is flat, turned inside out, with two nodes at one place or not a number, and moduli out of range, end with the status and leave the
/// results alone.
#[test]
fn wrong_cells_and_moduli_have_a_status() {
    for case in every(|case| case.element.dimension() > 1) {
        let d = case.element.dimension();
        let good = &case.samples[0];
        let with = |change: &dyn Fn(&mut Vec<f64>)| {
            let mut x = good.x.clone();
            change(&mut x);
            x
        };
        let flat = with(&|x| x.chunks_exact_mut(d).for_each(|x| x[d - 1] = 0.0));
        let point = with(&|x| x.fill(0.0));
        let inside_out = with(&|x| x.chunks_exact_mut(d).for_each(|x| x[0] = -x[0]));
        let together = with(&|x| x.copy_within(..d, d));
        let unknown = with(&|x| x[d] = f64::NAN);
        let far = with(&|x| x[d] = f64::INFINITY);
        let all = [(flat, 1), (point, 1), (inside_out, 1), (together, 1), (unknown, 1), (far, 1)];
        let wrong: Vec<_> = all.into_iter().map(|(x, status)| (good.with(x, good.moduli), status)).collect();
        let moduli = [[1.0, -1.0], [f64::NAN, 1.0], [-3.0, 1.0], [1.0, f64::NAN]];
        let wrong: Vec<_> = wrong.into_iter().chain(moduli.map(|m| (good.with(good.x.clone(), m), 3))).collect();
        let statuses: Vec<usize> = wrong.iter().map(|(_, status)| *status).collect();
        let bad = Case { samples: wrong.into_iter().map(|(sample, _)| sample).collect(), ..case };
        let bad = std::slice::from_ref(&bad);
        let found = c(bad, &[]).expect("the tests need a C compiler");
        let prefix = bad[0].prefix();
        for (outcome, status) in found.iter().zip(&statuses) {
            assert_eq!(outcome.status, *status, "{prefix}");
            assert!(outcome.constants.iter().chain(&outcome.rests).all(|k| *k == 7.0), "{prefix}");
        }
        // Python raises an error of its own where C divides by zero.
        let found: Vec<usize> = python(bad).into_iter().flatten().map(|outcome| outcome.status).collect();
        assert!(found.is_empty() || found == statuses, "{prefix} in Python: {found:?} for {statuses:?}");
        let bad = &bad[0];
        if bad.element.nodes() > 4 {
            break;
        }
    }
}

/// The checker of WGSL takes a time that grows with the square of a text: a fifth of a second at this length in bytes. Longer texts have more lines, of the kinds
/// that shorter ones have.
const LONG: usize = 60_000;

/// The syntax of the languages whose compilers are rarely there.
#[test]
fn shaders_and_cuda_are_valid_where_they_can_be_checked() {
    let cases = every(|case| case.element.nodes() <= 8 || case.element.nodes() == 27);
    for (tool, most) in [(Tool::Shaders, LONG), (Tool::Glslang, usize::MAX), (Tool::Cuda, usize::MAX)] {
        match tool.check(&cases, 0..most) {
            Some(count) => assert!(count > 10, "{tool:?} checked {count} files"),
            None => println!("not run: {tool:?} is not on PATH"),
        }
    }
}

#[test]
#[ignore = "takes half a minute; .ci/long has it"]
fn long_shaders_are_valid() {
    let cases = every(|case| case.element.nodes() <= 8 || case.element.nodes() == 27);
    match Tool::Shaders.check(&cases, LONG..usize::MAX) {
        Some(count) => assert!(count > 3, "{count} files"),
        None => println!("not run: {:?} is not on PATH", Tool::Shaders),
    }
}
