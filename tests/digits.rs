//! Digits that ill-conditioned problems keep: contrast, bounded and tied constants on flat shapes, springs on functions.

use crate::kit::place;
use crate::shapes::{Random, distorted, loaded};
use springfit_bodies::dynamics::{LinearSolver, Motion, Options, Simulation};
use springfit_bodies::model::{LengthSpring, Network, Support};
use springfit_bodies::solve::System;
use springfit_element::element::Element;
use springfit_element::material::{Material, Moduli, Plane};
use springfit_element::springs::Springs;
use springfit_fit::fit::{
    Balance, Fit, Higher, MotionWeight, Objective, Weight, bounded_constants, constants_of_kind, distance_from_optimum,
    fit_cells, fit_element,
};
use springfit_foundation::error::ErrorKind;
use springfit_foundation::scalar::{DoubleDouble, Real};
use springfit_foundation::symbolic::{Differentiable, Jet, Program, Scope};
use springfit_studies::study::{Family, StabilityRow, Verdict, stability};
use std::sync::Arc;

/// Springs in a row of constants 1 and `ratio` alternately, pulled at the end: what is left, and the error of the end's way, which is
/// `Σ 1/k`.
fn row(count: usize, ratio: f64) -> (f64, f64) {
    let constant = |i: usize| if i.is_multiple_of(2) { 1.0 } else { ratio };
    let lengths = (0..count).map(|i| LengthSpring { points: [i, i + 1], constant: constant(i), rest: 1.0 }).collect();
    let network = Network { dimension: 1, lengths, others: Vec::new() };
    let points: Vec<f64> = (0..=count).map(|i| i as f64).collect();
    let mut support = Support { prescribed: vec![None; count + 1] };
    support.prescribed[0] = Some(0.0);
    let mut f = vec![0.0; count + 1];
    f[count] = 1.0;
    let system = System::new(&network.stiffness(&points), &support).unwrap();
    let Some(factor) = system.factorize().unwrap() else { return (1.0, 1.0) };
    let (u, left) = system.solve(&factor, &f);
    let exact: f64 = (0..count).map(|i| 1.0 / constant(i)).sum();
    (left, (u[count] - exact).abs() / exact)
}

/// Soft springs beside stiff ones keep their digits, and where they cannot the solution says so.
#[test]
fn springs_in_a_row_keep_their_digits_at_any_contrast() {
    for decade in -12..=12 {
        let (left, error) = row(64, 10f64.powi(decade));
        assert!(left < 1e-9 && error < 1e-12, "1e{decade}: {error:e}, {left:e} is left");
    }
    for decade in [-300, -30, -20, -17, -16, -15, -14, -13, 13, 14, 15, 16, 17, 20, 30, 300] {
        let (left, error) = row(64, 10f64.powi(decade));
        assert!(left > 1e-6 || error < 1e-9, "1e{decade}: {error:e}, but only {left:e} is left");
    }
}

/// Springs that push make matrices that are not positive definite, with zeros on the diagonal at a ratio of −1, where a factor needs pivots.
#[test]
fn springs_that_push_in_a_row_keep_their_digits() {
    for (count, ratio) in [(65, -1.0), (3, -1.0), (64, -0.5), (64, -2.0), (64, -1e-3), (64, -1e6)] {
        let (left, error) = row(count, ratio);
        assert!(left < 1e-9 && error < 1e-12, "{count}, {ratio}: {error:e}, {left:e} is left");
    }
}

/// A motion that is next to none: the matrix is positive definite, but has no incomplete factor. That is what is said of it, whatever
/// the solver; it is not said to release energy.
#[test]
fn definiteness_is_the_same_for_every_solver() {
    let spring = |points, constant| LengthSpring { points, constant, rest: 2f64.sqrt() };
    let network = |constant| Network {
        dimension: 2,
        lengths: vec![spring([0, 1], 1.0), spring([1, 2], constant)],
        others: Vec::new(),
    };
    let (points, masses) = ([0.0, 0.0, 1.0, 1.0, 2.0, 0.0], [1.0; 3]);
    let mut support = Support { prescribed: vec![None; 6] };
    support.fix(&[0, 2], &[0, 1], 2);
    let begun = |constant, solver| {
        let network = network(constant);
        let motion = Motion { support: support.clone(), ..Motion::free(&network, &points, &masses) };
        Simulation::new(motion, Options { step: 1e12, linear: true, solver, ..Options::default() }).err()
    };
    for tolerance in [0.9, 1e-8, 1e-15] {
        let gradients = LinearSolver::ConjugateGradients { tolerance };
        assert!(begun(1e-15, LinearSolver::Factor).is_none());
        let error = begun(1e-15, gradients).unwrap();
        assert_eq!((error.key(), error.kind()), (Some("model"), ErrorKind::Infeasible), "{error}");
        for solver in [LinearSolver::Factor, gradients] {
            let error = begun(-1e-3, solver).unwrap();
            assert_eq!(error.key(), Some("step"), "{error}");
            assert!(begun(1e-3, solver).is_none());
        }
    }
}

struct Case {
    element: Arc<Element>,
    springs: Springs,
    x: Vec<f64>,
    moduli: Moduli,
}

/// A shipped element, with some unevenness, of which the last coordinate is `flat` times as long.
fn flattened(name: &str, flat: f64) -> Case {
    let element = loaded(name);
    let d = element.dimension();
    let uneven = |i: usize| 1.0 + 0.03 * ((7 * i + 3) % 11) as f64;
    let x = element.positions.iter().enumerate();
    let x = x.map(|(i, x)| x * uneven(i) * if i % d + 1 == d { flat } else { 1.0 }).collect();
    let moduli = Material::for_body(d, 1e4, 0.3, None, None).unwrap().moduli();
    Case { springs: Springs::select(&element, None).unwrap(), element, x, moduli }
}

/// The largest error relative to the largest constant.
fn distance(found: &[f64], exact: &[DoubleDouble]) -> f64 {
    let size = exact.iter().fold(0.0f64, |size, k| size.max(k.hi.abs()));
    let away = found.iter().zip(exact).map(|(a, b)| (DoubleDouble::from(*a) - b).rounded().abs());
    away.fold(0.0, f64::max) / size
}

/// The optimality conditions in twice the digits say which constants are zero, and what the others are.
#[test]
fn bounded_constants_of_flat_cells_are_optimal() {
    let objectives = [
        Objective::Divergence(Balance::DEFAULT),
        Objective::Divergence(Balance::new(0.0).unwrap()),
        Objective::Divergence(Balance::new(1.0).unwrap()),
        Objective::Frobenius(Weight::None),
        Objective::Frobenius(Weight::Modal(Higher::DEFAULT)),
        Objective::Frobenius(Weight::Relative),
    ];
    let mut bound = 0;
    for (name, objective) in ["quad4", "hex8"].into_iter().flat_map(|name| objectives.map(|o| (name, o))) {
        // Twice the digits take their time with 28 springs.
        for decade in if name == "hex8" { 0..2 } else { 0..5 } {
            let Case { element, springs, x, moduli } = flattened(name, 10f64.powi(-decade));
            let fit = Fit { nonnegative: true, ..Fit::new(objective) };
            let nodes: Vec<usize> = (0..element.nodes()).collect();
            let fits = fit_cells(&element, &springs, &x, &nodes, moduli, &fit, &mut |_| {}).unwrap();
            let told = format!("{name} 1 : 1e-{decade} {}", objective.title());
            if fits.deficient > 0 {
                continue;
            }
            assert_eq!(fits.unreached, 0, "{told}");
            let k = &fits.constants;
            let exact = bounded_constants(&element, &springs, &x, &moduli, &fit, k).unwrap();
            let exact = exact.unwrap_or_else(|| panic!("{told}: not the optimum"));
            assert!(distance(k, &exact) < 1e-9, "{told}: {:e}", distance(k, &exact));
            bound += k.iter().filter(|k| **k == 0.0).count();
        }
    }
    assert!(bound > 5, "the bound was hardly ever active");
}

/// The reference in other kinds of numbers ties what the fit ties.
#[test]
fn tied_constants_agree_with_twice_the_digits() {
    let weights = [Weight::None, Weight::OffDiagonal, Weight::Modal(Higher::DEFAULT), Weight::Relative];
    for (name, weight) in ["quad4", "tet4", "hex8"].into_iter().flat_map(|name| weights.map(|w| (name, w))) {
        if name == "tet4" && matches!(weight, Weight::Modal(_)) {
            continue;
        }
        let Case { element, springs, x, moduli } = flattened(name, 0.1);
        let fit = Fit { tied: true, ..Fit::new(Objective::Frobenius(weight)) };
        let found = fit_element(&element, &springs, &x, moduli, &fit).unwrap();
        let exact = constants_of_kind(&DoubleDouble::from(0.0), &element, &springs, &x, &moduli, &fit).unwrap();
        assert!(distance(&found, &exact) < 1e-12, "{name} {}: {:e}", weight.name(), distance(&found, &exact));
    }
}

/// The sweep of an element with springs on functions loses nothing, unless two nodes are next to one.
#[test]
fn coupled_springs_keep_their_digits() {
    let own = |name: &str| {
        let path = place("examples/elements").join(name);
        Element::load(path.to_str().unwrap()).unwrap()
    };
    for name in ["tri3_coupled.toml", "tet4_coupled.toml"] {
        let rows = stability(Some(own(name)), &mut |_| {}).unwrap().rows;
        let lost = rows.iter().filter(|row| row.verdict == Verdict::Lost);
        let lost: Vec<String> = lost.map(|row| format!("{}, {}: {:?}", row.case, row.method, row.error)).collect();
        assert!(lost.is_empty() && rows.len() > 600, "{name}: {lost:#?}");
        // An optimum of zero is reached up to the rounding of the constants.
        let spectral = |row: &&StabilityRow| row.family == Family::Young && row.method.starts_with("spectral");
        assert!(rows.iter().filter(spectral).count() > 20);
        for row in rows.iter().filter(spectral) {
            assert!(row.verdict == Verdict::Accurate, "{name}, {}, {}: {:?}", row.case, row.method, row.verdict);
        }
    }
    let element = own("tri3_coupled.toml");
    // Six springs have every stiffness of the triangle: the value that is said of the optimum is reached.
    let springs = Springs::select(&element, None).unwrap();
    for poisson in [-0.9, 0.0, 0.3, 0.49] {
        let moduli = Material::for_body(2, 1e4, poisson, None, None).unwrap().moduli();
        for weight in MotionWeight::all().filter(|weight| !matches!(weight, MotionWeight::Modal(_))) {
            let fit = Fit::new(Objective::Spectral(weight));
            let x = [0.0, 0.0, 1.1, 0.2, 0.3, 0.9];
            let fits = fit_cells(&element, &springs, &x, &[0, 1, 2], moduli, &fit, &mut |_| {}).unwrap();
            let certificate = fits.certificates[0];
            let said = (&fits.constants[..], certificate.value);
            let distance = distance_from_optimum(&element, &springs, &x, &moduli, &fit, said).unwrap();
            assert!(distance < 1.1 * (1e-8 + certificate.rounding()), "{distance:e}");
        }
    }
}

/// Identities of elementary functions in pairs of doubles, and derivatives against those in doubles.
#[test]
fn functions_of_pairs_of_doubles_have_thirty_digits() {
    let scope = Scope::new(&["x"]);
    let one = DoubleDouble::from(1.0);
    for x in [0.01, 0.3, 0.7, 0.99] {
        let x = DoubleDouble::from(x) / &DoubleDouble::from(3.0) + &DoubleDouble::from(0.5 * x);
        for (text, expected) in [
            ("sin(x)^2 + cos(x)^2", one),
            ("exp(ln(x))", x),
            ("ln(exp(20*x))/20", x),
            ("tan(atan(5*x))/5", x),
            ("sin(asin(x))", x),
            ("cos(acos(x))", x),
            ("sin(x + 8*atan(1)) - sin(x) + 1", one),
            ("sqrt(x)^2", x),
            ("x^(1/3)*x^(2/3)", x),
            ("x^5*x^(-4)", x),
            ("4*atan(1/5) - atan(1/239) - atan(1) + 1", one),
            ("exp(x)*exp(-x)", one),
        ] {
            let expression = scope.expression(text).unwrap();
            let program = Program::of(&expression);
            let jet = program.jet(&[x], 1);
            let error = (jet.value - &expected).rounded().abs();
            assert!(error < 1e-29, "{text} at {x:?} errs by {error:e}");
            agrees(&jet, &program.jet(&[x.hi], 1), text);
        }
    }
}

fn agrees<T: Differentiable>(jet: &Jet<T>, plain: &Jet, text: &str) {
    for (a, b) in jet.gradient.iter().chain(&jet.hessian).zip(plain.gradient.iter().chain(&plain.hessian)) {
        assert!((a.rounded() - b).abs() < 1e-9 * (1.0 + b.abs()), "{text}: {:e} {b:e}", a.rounded());
    }
}

/// Rounding hides the optimum of the relative weight from 1 : 30 on; double-double numbers find and prove it.
#[test]
fn optima_of_needles_are_proved() {
    let mut random = Random(5);
    for name in ["tri3", "quad4", "tet4", "wedge6"] {
        let element = loaded(name);
        let (d, springs) = (element.dimension(), Springs::select(&element, None).unwrap());
        let moduli = Material::for_body(d, 1e4, 0.3, (d == 2).then_some(Plane::Strain), None).unwrap().moduli();
        for aspect in [30.0, 100.0, 300.0, 1000.0] {
            let stretched =
                |x: Vec<f64>| x.into_iter().enumerate().map(move |(i, x)| if i % d == 0 { aspect * x } else { x });
            let x: Vec<f64> = (0..16).flat_map(|_| stretched(distorted(&element, &mut random))).collect();
            let cells: Vec<usize> = (0..16 * element.nodes()).collect();
            for weight in [MotionWeight::None, MotionWeight::Modal(Higher::DEFAULT), MotionWeight::Relative] {
                let fit = Fit::new(Objective::Spectral(weight));
                let fits = fit_cells(&element, &springs, &x, &cells, moduli, &fit, &mut |_| {}).unwrap();
                assert_eq!(fits.unreached, 0, "{name} 1 : {aspect} {weight:?}");
                assert!(fits.certificates.iter().all(|c| c.gap() <= 1e-8), "{name} 1 : {aspect} {weight:?}");
            }
        }
    }
}
