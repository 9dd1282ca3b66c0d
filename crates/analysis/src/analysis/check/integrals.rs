//! What the quadrature rules of an element integrate: its own rule the linear functions, and those of loads and masses
//! all that these need.

use super::property::Property;
use super::space::{exponents, monomial, places};
use crate::element::{Element, Integrand, Quadrature, Tabulation};

/// The tolerance of integrals of numbers of size one over the reference cell: some ten thousand rounding errors.
const ROUNDING: f64 = 1e-11;
/// The degree of the loads with which the rules are tested.
// A rule is chosen by the degree of the load, and the choice has no cases that begin above two.
const LOAD: usize = 2;
/// The degree of the reference rule, by dimension.
// A rule of degree 60 has 31 points along each direction, and one of degree 30 in space 16, which are 4 096 in a box.
// Both are far beyond the degree of shape functions that are in use, with a load of degree two.
const FINE: [usize; 3] = [60, 60, 30];

pub fn properties(element: &Element) -> Vec<Property> {
    vec![linear(element), loads(element)]
}

/// `∫ ξ_k` by the rule of the stiffness and by that of its volumetric term. A rule that misses it gives no mean over
/// the cell.
fn linear(element: &Element) -> Property {
    let d = element.dimension();
    let fine = Quadrature::of_degree(element.cell, 1);
    let places = places(element);
    let table = &element.tabulation;
    let mut worst: f64 = 0.0;
    for weights in [&table.weights, &table.volumetric].into_iter().filter(|weights| !weights.is_empty()) {
        for k in 0..d {
            let own: f64 = places.iter().zip(weights).map(|(x, w)| w * x[k]).sum();
            let exact: f64 = fine.points.chunks_exact(d).zip(&fine.weights).map(|(x, w)| w * x[k]).sum();
            worst = worst.max((own - exact).abs());
        }
    }
    let finding = format!("integrals of the coordinates by the rule, largest error {worst:.1e}");
    Property::new("rule of linear functions", worst < ROUNDING, finding).with(worst)
}

/// `∫ N_a ξ^e`, of degree at most 2, and `∫ N_a N_b` by the rules of loads and masses, compared with a rule of much
/// higher degree.
fn loads(element: &Element) -> Property {
    let d = element.dimension();
    let fine = Quadrature::of_degree(element.cell, FINE[d - 1]);
    let fine = Tabulation::new(&element.functions, &fine, None);
    let mut worst: f64 = 0.0;
    for degree in 0..=LOAD {
        let own = element.integration_table(Integrand::Load(degree));
        for e in (0..=degree).flat_map(|degree| exponents(d, degree as i32)) {
            let load = |at: &[f64]| monomial(at, &e);
            worst = worst.max(difference(&moments(element, &own, load), &moments(element, &fine, load)));
        }
    }
    let own = element.integration_table(Integrand::Mass);
    worst = worst.max(difference(&products(&own), &products(&fine)));
    let points = |integrand| element.integration_table(integrand).points();
    let finding = format!(
        "loads of degree {LOAD} at {} points, masses at {}, error {worst:.1e}",
        points(Integrand::Load(LOAD)),
        points(Integrand::Mass)
    );
    Property::new("loads and masses", worst < ROUNDING * element.cell.content(), finding).with(worst)
}

/// `∫ N_a f` over the reference cell.
fn moments(element: &Element, table: &Tabulation, f: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let (n, d) = (table.nodes, element.dimension());
    let mut moments = vec![0.0; n];
    for (values, w) in table.values.chunks_exact(n).zip(&table.weights) {
        let at = |k: usize| values.iter().zip(element.positions.chunks_exact(d)).map(|(n, x)| n * x[k]).sum();
        let at: Vec<f64> = (0..d).map(at).collect();
        let value = w * f(&at);
        moments.iter_mut().zip(values).for_each(|(m, n)| *m += n * value);
    }
    moments
}

/// `∫ N_a N_b` over the reference cell, `[nodes × nodes]`.
fn products(table: &Tabulation) -> Vec<f64> {
    let n = table.nodes;
    let mut products = vec![0.0; n * n];
    for (values, w) in table.values.chunks_exact(n).zip(&table.weights) {
        for (row, a) in products.chunks_exact_mut(n).zip(values) {
            row.iter_mut().zip(values).for_each(|(m, b)| *m += w * a * b);
        }
    }
    products
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
