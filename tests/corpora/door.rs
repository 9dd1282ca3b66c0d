//! Calls of public functions, read from bytes: they return errors and do not panic, and what they return is finite.
//!
//! The bytes choose the element, the fit and the moduli; the rest are places of nodes, node numbers and lengths, mostly right with some
//! replaced.

use springfit_bodies::model::{LengthSpring, Network, Support};
use springfit_bodies::solve::System;
use springfit_element::element::Element;
use springfit_element::material::{Material, Moduli};
use springfit_element::springs::Springs;
use springfit_fit::fit::{
    CellFits, ExactFit, Fit, Objective, Rest, Weight, bounded_constants, condition, constants_of_kind,
    distance_from_optimum, element_errors, fit_cells, fit_element, fit_exact,
};
use springfit_foundation::scalar::DoubleDouble;
use std::sync::OnceLock;

/// Small elements: each call takes less than a millisecond.
const ELEMENTS: [&str; 6] = ["bar2", "tri3", "quad4", "tet4", "pyramid5", "tri6"];
/// What no coordinate or modulus should be, and what is at the ends of the range of numbers.
const HOSTILE: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    0.0,
    -0.0,
    -1.0,
    1e-200,
    1e200,
    1e-12,
];

/// The bytes as choices; zeros where they end.
struct Choices<'a>(&'a [u8]);

impl Choices<'_> {
    fn byte(&mut self) -> usize {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        usize::from(*first)
    }

    fn below(&mut self, count: usize) -> usize {
        self.byte() % count
    }

    /// Mostly what is good.
    fn number(&mut self, good: f64) -> f64 {
        match self.byte() {
            choice @ 0..=15 => HOSTILE[choice % HOSTILE.len()],
            choice @ 16..=31 => good * 10f64.powi(4 * (choice as i32 - 24)),
            choice @ 32..=63 => good + (choice as f64 - 48.0) / 64.0,
            _ => good,
        }
    }

    fn list<T: Clone>(&mut self, mut list: Vec<T>, more: T) -> Vec<T> {
        match self.byte() {
            0 => list.clear(),
            1 => list.truncate(list.len().saturating_sub(1)),
            2 => list.push(more),
            _ => {}
        }
        list
    }
}

pub fn check(bytes: &[u8]) {
    let mut choices = Choices(bytes);
    let element = &elements()[choices.below(ELEMENTS.len())];
    // Sometimes the springs are those of another element.
    let other = &elements()[choices.below(ELEMENTS.len())];
    let owner = if choices.byte() == 0 { other } else { element };
    let springs = Springs::select(owner, None).expect("a shipped element has springs");
    let material = Material::for_body(element.dimension(), 1e4, 0.3, None, None).expect("a common material");
    let Moduli { lambda, mu } = material.moduli();
    let moduli = Moduli { lambda: choices.number(lambda), mu: choices.number(mu) };
    let objectives = Objective::all(true);
    let mut fit = Fit::new(objectives[choices.below(objectives.len())]);
    (fit.tied, fit.nonnegative) = (choices.below(2) == 1, choices.below(2) == 1);
    fit.rest = [Rest::Mesh, Rest::Mesh, Rest::Free, Rest::Zero][choices.below(4)];
    let x: Vec<f64> = element.positions.iter().map(|x| choices.number(*x)).collect();
    let x = choices.list(x, 0.0);
    let nodes: Vec<usize> = (0..element.nodes()).map(|a| if choices.byte() == 0 { usize::MAX } else { a }).collect();
    let nodes = choices.list(nodes, 0);
    let all_finite = |constants: &[f64]| assert!(constants.iter().all(|k| k.is_finite()), "{constants:?}");
    if let Ok(constants) = fit_element(element, &springs, &x, moduli, &fit) {
        all_finite(&constants);
        let said = (&choices.list(constants.clone(), f64::NAN)[..], choices.number(1.0));
        let _ = distance_from_optimum(element, &springs, &x, &moduli, &fit, said);
        let _ = bounded_constants(element, &springs, &x, &moduli, &fit, said.0);
    }
    if let Ok(constants) = constants_of_kind(&DoubleDouble::from(0.0), element, &springs, &x, &moduli, &fit) {
        assert!(constants.iter().all(|k| k.hi.is_finite()), "{constants:?}");
    }
    let _ = condition(Weight::None, element, &springs, &x, &moduli);
    if let Ok(fits) = fit_cells(element, &springs, &x, &nodes, moduli, &fit, &mut |_| {}) {
        all_finite(&fits.constants);
        let constants = choices.list(fits.constants.clone(), 0.0);
        let _ = element_errors(element, &x, &nodes, moduli, &CellFits { constants, ..fits });
    }
    if let Ok(fits) = fit_exact(element, &x, &nodes, material, &ExactFit::default(), &mut |_| {}) {
        all_finite(&fits.constants);
    }
    solve(&mut choices);
}

/// A chain of springs, pulled at its end.
fn solve(choices: &mut Choices) {
    let count = 1 + choices.below(6);
    let spring = |i: usize, constant: f64| LengthSpring { points: [i, i + 1], constant, rest: 1.0 };
    let lengths = (0..count).map(|i| spring(i, choices.number(1.0))).collect();
    let network = Network { dimension: 1, lengths, others: Vec::new() };
    let points: Vec<f64> = (0..=count).map(|i| i as f64).collect();
    let mut support = Support { prescribed: vec![None; count + 1] };
    support.prescribed[0] = Some(choices.number(0.0));
    let mut forces = vec![0.0; count + 1];
    forces[count] = choices.number(1.0);
    let Ok(system) = System::new(&network.stiffness(&points), &support) else { return };
    let Ok(Some(factor)) = system.factorize() else { return };
    let (u, left) = system.solve(&factor, &forces);
    assert_eq!(u.len(), count + 1);
    assert!(!(left <= 1e-6) || u.iter().all(|u| u.is_finite()), "{u:?} is said to be solved to {left}");
}

/// Parsed and proved once, not for every call.
fn elements() -> &'static [Element] {
    static LOADED: OnceLock<Vec<Element>> = OnceLock::new();
    LOADED.get_or_init(|| ELEMENTS.iter().map(|name| Element::load(name).expect("it is shipped")).collect())
}
