//! The public functions of the fits, called with what is wrong: they return errors and do not panic, and no constant that they
//! return is infinite or not a number.

use crate::shapes::{Random, loaded};
use springfit_element::element::Element;
use springfit_element::material::{Energy, Material, Moduli, State};
use springfit_element::springs::{Force, Springs};
use springfit_fit::fit::published::{self, Method};
use springfit_fit::fit::{
    Balance, CellFits, ClosedForm, Fit, Higher, MotionWeight, Objective, Rest, SampledFit, Sampling, Search, Solver,
    Source, Topology, Weight, condition, constants_in, constants_of_kind, distance_from_optimum, element_errors,
    fit_cells, fit_element, fit_sampled,
};
use springfit_foundation::error::{Error, ErrorKind, Result};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

const ELEMENTS: [&str; 5] = ["bar2", "tri3", "quad4", "tet4", "hex8"];
/// What no length, node number or modulus should be.
const HOSTILE: [f64; 10] =
    [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 0.0, -0.0, f64::MIN_POSITIVE, -1.0, 1e200];

struct Case {
    element: Arc<Element>,
    springs: Springs,
    x: Vec<f64>,
    moduli: Moduli,
}

fn case(name: &str) -> Case {
    let element = loaded(name);
    let material = Material::for_body(element.dimension(), 1e4, 0.3, None, None).unwrap();
    let springs = Springs::select(&element, None).unwrap();
    Case { x: element.positions.clone(), springs, moduli: material.moduli(), element }
}

/// A fit of each objective, constants alone, tied and bounded, and by a search; and those whose springs pull at rest.
fn fits() -> Vec<Fit> {
    let plain = Objective::all(true).into_iter().map(Fit::new);
    let bounded = Objective::all(true).into_iter().map(|o| Fit { nonnegative: true, tied: true, ..Fit::new(o) });
    let solver = Solver::General { method: Search::NelderMead, iterations: 5, topology: None };
    let searched = Objective::all(true).into_iter().map(|o| Fit { solver, ..Fit::new(o) });
    let weights = [Weight::None, Weight::OffDiagonal];
    let pulling = [Rest::Free, Rest::Zero]
        .into_iter()
        .flat_map(|rest| weights.map(|weight| Fit { rest, ..Fit::new(Objective::Frobenius(weight)) }));
    plain.chain(bounded).chain(searched).chain(pulling).collect()
}

/// The result of a call that does not panic.
fn outcome<T>(what: &str, call: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| panic!("{what} panics"))
}

fn assert_invalid<T>(what: &str, call: impl FnOnce() -> Result<T>) {
    let Err(error) = outcome(what, call) else { panic!("{what} is accepted") };
    assert!([ErrorKind::Invalid, ErrorKind::Limit].contains(&error.kind()), "{what}: {error}");
}

fn assert_finite(what: &str, found: Result<Vec<f64>>) {
    if let Ok(constants) = found {
        assert!(constants.iter().all(|k| k.is_finite()), "{what}: {constants:?}");
    }
}

fn cells(case: &Case, points: &[f64], nodes: &[usize], moduli: Moduli, fit: &Fit) -> Result<CellFits> {
    fit_cells(&case.element, &case.springs, points, nodes, moduli, fit, &mut |_| {})
}

#[test]
fn arrays_of_wrong_length_are_refused() {
    let fit = Fit::new(Objective::Frobenius(Weight::None));
    for name in ELEMENTS {
        let case = case(name);
        let (element, springs, moduli) = (&case.element, &case.springs, case.moduli);
        let all: Vec<usize> = (0..element.nodes()).collect();
        let material = Material::for_body(element.dimension(), 1.0, 0.3, None, None).unwrap();
        let (energy, state) = (Energy::load("neo-hookean", material).unwrap(), material.state());
        let one = fit_element(element, springs, &case.x, moduli, &fit).unwrap();
        let fitted = cells(&case, &case.x, &all, moduli, &fit).unwrap();
        let sampled = |points: &[f64], nodes: &[usize]| {
            let fit = SampledFit::default();
            fit_sampled(element, springs, points, nodes, &energy, state, &fit, &mut |_| {})
        };
        for wrong in [vec![], case.x[1..].to_vec(), [&case.x[..], &[0.0]].concat()] {
            let what = format!("{name} with {} coordinates", wrong.len());
            assert_invalid(&what, || fit_element(element, springs, &wrong, moduli, &fit));
            assert_invalid(&what, || constants_of_kind(&0.0, element, springs, &wrong, &moduli, &fit));
            assert_invalid(&what, || constants_in(Weight::None, springs, &element.tabulation, &wrong, &moduli));
            assert_invalid(&what, || condition(Weight::None, element, springs, &wrong, &moduli));
            assert_invalid(&what, || distance_from_optimum(element, springs, &wrong, &moduli, &fit, (&one, 1.0)));
            if element.dimension() == 1 && wrong.len() > case.x.len() {
                // One point more, which no cell has.
                continue;
            }
            assert_invalid(&what, || cells(&case, &wrong, &all, moduli, &fit));
            assert_invalid(&what, || sampled(&wrong, &all));
            assert_invalid(&what, || element_errors(element, &wrong, &all, moduli, &fitted));
        }
        let outside: Vec<usize> = all.iter().map(|a| a + 1).collect();
        let huge = vec![usize::MAX; all.len()];
        for wrong in [all[1..].to_vec(), [&all[..], &[0]].concat(), outside, huge] {
            let what = format!("{name} with nodes {wrong:?}");
            assert_invalid(&what, || cells(&case, &case.x, &wrong, moduli, &fit));
            assert_invalid(&what, || sampled(&case.x, &wrong));
            assert_invalid(&what, || element_errors(element, &case.x, &wrong, moduli, &fitted));
            let material = Material::for_body(element.dimension(), 1.0, 0.3, None, None).unwrap();
            assert_invalid(&what, || published::fit(Method::VanGelder, element, springs, &case.x, &wrong, material));
        }
        let fewer = CellFits { constants: one[1..].to_vec(), ..fitted.clone() };
        assert_invalid("fewer constants", || element_errors(element, &case.x, &all, moduli, &fewer));
        let lawless = CellFits { force: Force::Laws(Vec::new()), ..fitted };
        assert_invalid("no laws", || element_errors(element, &case.x, &all, moduli, &lawless));
    }
}

#[test]
fn springs_of_other_elements_are_refused() {
    let fit = Fit::new(Objective::Frobenius(Weight::None));
    for (name, other) in ELEMENTS.into_iter().flat_map(|a| ELEMENTS.map(|b| (a, b))).filter(|(a, b)| a != b) {
        let (case, springs) = (case(name), case(other).springs);
        let (element, x, moduli) = (&case.element, &case.x, case.moduli);
        let what = format!("{name} with springs of {other}");
        assert_invalid(&what, || fit_element(element, &springs, x, moduli, &fit));
        assert_invalid(&what, || constants_of_kind(&0.0, element, &springs, x, &moduli, &fit));
        assert_invalid(&what, || constants_in(Weight::None, &springs, &element.tabulation, x, &moduli));
        assert_invalid(&what, || condition(Weight::None, element, &springs, x, &moduli));
        assert_invalid(&what, || ClosedForm::new(element, &springs, true));
    }
}

#[test]
fn numbers_without_meaning_are_refused() {
    for wrong in [f64::NAN, f64::INFINITY, -3.0, -0.1, 1.1, 7.0] {
        assert_invalid("higher", || Higher::new(wrong));
        assert_invalid("balance", || Balance::new(wrong));
    }
    assert_invalid("higher", || Higher::new(0.0));
    assert!(Balance::new(0.0).is_ok() && Balance::new(1.0).is_ok() && Higher::new(1.0).is_ok());
    let case = case("quad4");
    let (element, springs, x) = (&case.element, &case.springs, &case.x);
    for (lambda, mu) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::INFINITY, 1.0), (1.0, -1.0), (-1.0, 0.1), (0.0, 0.0)] {
        let (what, moduli) = (format!("lambda {lambda}, mu {mu}"), Moduli { lambda, mu });
        for fit in fits() {
            assert_invalid(&what, || fit_element(element, springs, x, moduli, &fit));
            assert_invalid(&what, || constants_of_kind(&0f32, element, springs, x, &moduli, &fit));
        }
        assert_invalid(&what, || condition(Weight::None, element, springs, x, &moduli));
    }
    for objective in Objective::all(true) {
        for (iterations, sparsity) in [(0, 0.5), (u64::MAX, 0.5), (10, f64::NAN), (10, -1.0)] {
            let topology = Some(Topology { sparsity });
            let solver = Solver::General { method: Search::ParticleSwarm, iterations, topology };
            let fit = Fit { solver, ..Fit::new(objective) };
            assert_invalid("a search", || fit_element(element, springs, x, case.moduli, &fit));
        }
    }
}

/// A weight that no closed form has is an error, whoever asks.
#[test]
fn weights_that_divide_by_the_stiffness_have_no_closed_form() {
    let case = case("quad4");
    let (element, springs, x) = (&case.element, &case.springs, &case.x);
    let is_unsupported = |error: Error| assert_eq!(error.kind(), ErrorKind::Unsupported, "{error}");
    is_unsupported(ClosedForm::new(element, springs, true).unwrap().fit(Weight::Relative).unwrap_err());
    is_unsupported(constants_in(Weight::Relative, springs, &element.tabulation, x, &case.moduli).unwrap_err());
    is_unsupported(condition(Weight::Relative, element, springs, x, &case.moduli).unwrap_err());
}

/// A spectral fit under a weight is another than one without.
#[test]
fn every_weight_of_motions_counts() {
    let case = case("quad4");
    let x: Vec<f64> = case.x.iter().enumerate().map(|(i, x)| x * (1.0 + 0.1 * i as f64)).collect();
    let of = |w| fit_element(&case.element, &case.springs, &x, case.moduli, &Fit::new(Objective::Spectral(w))).unwrap();
    let found: Vec<Vec<f64>> = MotionWeight::all().map(of).collect();
    assert!(found[0] != found[1] && found[1] != found[2] && found[0] != found[2]);
}

/// One, two or three numbers of a good call are replaced by hostile ones.
#[test]
fn hostile_numbers_do_not_panic() {
    let mut random = Random(5);
    for name in ELEMENTS {
        let case = case(name);
        let (element, springs) = (&case.element, &case.springs);
        let all: Vec<usize> = (0..element.nodes()).collect();
        for round in 0..40 {
            for fit in fits() {
                let (mut x, mut moduli) = (case.x.clone(), case.moduli);
                for _ in 0..=round % 3 {
                    let value = HOSTILE[random.below(HOSTILE.len())];
                    match random.below(x.len() + 2) {
                        0 => moduli.lambda = value,
                        1 => moduli.mu = value,
                        place => x[place - 2] = value,
                    }
                }
                let what = format!("{name} {} at {x:?} with {moduli:?}", fit.objective.title());
                let fitted = outcome(&what, || cells(&case, &x, &all, moduli, &fit));
                if let Ok(CellFits { constants, parameters, .. }) = &fitted {
                    assert_finite(&what, Ok([&constants[..], parameters].concat()));
                }
                let one = outcome(&what, || fit_element(element, springs, &x, moduli, &fit));
                if let Ok(constants) = &one {
                    let fitted = fitted.unwrap();
                    let _ = outcome(&what, || element_errors(element, &x, &all, moduli, &fitted));
                    let said = (&constants[..], HOSTILE[random.below(HOSTILE.len())]);
                    let _ = outcome(&what, || distance_from_optimum(element, springs, &x, &moduli, &fit, said));
                }
                assert_finite(&what, one);
                assert_finite(&what, outcome(&what, || constants_of_kind(&0.0, element, springs, &x, &moduli, &fit)));
                let weight = fit.objective.weight().unwrap_or(Weight::Relative);
                let table = &element.tabulation;
                assert_finite(&what, outcome(&what, || constants_in(weight, springs, table, &x, &moduli)));
                let _ = outcome(&what, || condition(weight, element, springs, &x, &moduli));
            }
        }
    }
}

#[test]
fn hostile_samplings_do_not_panic() {
    let mut random = Random(7);
    for name in ["tri3", "tet4"] {
        let case = case(name);
        let all: Vec<usize> = (0..case.element.nodes()).collect();
        let material = Material::for_body(case.element.dimension(), 1.0, 0.3, None, None).unwrap();
        let (energy, good) = (Energy::load("neo-hookean", material).unwrap(), material.state());
        for _ in 0..200 {
            let mut any = |good: f64| if random.below(3) > 0 { good } else { HOSTILE[random.below(HOSTILE.len())] };
            let mut fit = SampledFit { higher: any(1.0), starts: 1, ..SampledFit::default() };
            let stretch = [any(-0.1), any(0.1)];
            fit.sampling = Sampling { shapes: 5, held_out: 2, stretch, perturbation: any(0.05), ..Sampling::default() };
            let d = case.element.dimension();
            let numbers = [d * d, d * d + 1, case.x.len()][(any(1.0) != 1.0) as usize + (any(1.0) != 1.0) as usize];
            let list: Vec<f64> = (0..numbers).map(|i| any(if i % (d + 1) == 0 { 1.1 } else { 0.0 })).collect();
            if any(1.0) != 1.0 {
                fit.sampling.source = Source::Gradients(Arc::new(list));
            } else if any(1.0) != 1.0 {
                fit.sampling.source = Source::States(Arc::new(vec![list]));
            }
            let state = if any(1.0) == 1.0 { good } else { State::PlaneStrain { thickness: any(1.0) } };
            let x: Vec<f64> = case.x.iter().map(|x| if any(1.0) == 1.0 { *x } else { any(*x) }).collect();
            let what = format!("{name} {fit:?} {state:?} at {x:?}");
            let found = outcome(&what, || {
                fit_sampled(&case.element, &case.springs, &x, &all, &energy, state, &fit, &mut |_| {})
            });
            assert_finite(&what, found.map(|found| found.fits.constants));
        }
    }
}
