//! The space that the shape functions span, their gradients, and the quadrature.

use super::property::Property;
use crate::element::{Element, Quadrature, Tabulation};
use crate::material::Moduli;
use crate::stiffness::Geometry;
use nalgebra::DMatrix;

/// The tolerance of identities of functions of size one: some ten thousand rounding errors.
const ROUNDING: f64 = 1e-11;
/// The step of central differences, whose error is its square. The rounding of values over it is as small.
const STEP: f64 = 1e-5;

pub fn properties(element: &Element) -> Vec<Property> {
    vec![kronecker(element), unity(element), completeness(element), gradients(element), rule(element), degree(element)]
}

/// Points inside the cell at which identities are sampled.
fn samples(element: &Element) -> Vec<f64> {
    Quadrature::of_degree(element.cell, 7).points
}

fn kronecker(element: &Element) -> Property {
    let d = element.dimension();
    let mut worst: f64 = 0.0;
    let mut limits = 0;
    for (a, n) in element.functions.values.iter().enumerate() {
        for (b, at) in element.positions.chunks_exact(d).enumerate() {
            let value = n.evaluate(at);
            // If a function has no value at a node, its limit was tested when the file was loaded.
            if value.is_finite() {
                worst = worst.max((value - f64::from(u8::from(a == b))).abs());
            } else {
                limits += 1;
            }
        }
    }
    let limit = if limits > 0 { format!(", {limits} values by their limits") } else { String::new() };
    Property::new("Kronecker", worst < ROUNDING, format!("largest |N_a(x_b) - delta_ab| {worst:.1e}{limit}"))
        .with(worst)
}

fn unity(element: &Element) -> Property {
    let defect = |at: &[f64]| (element.functions.values.iter().map(|n| n.evaluate(at)).sum::<f64>() - 1.0).abs();
    let worst = samples(element).chunks_exact(element.dimension()).map(defect).fold(0.0, f64::max);
    Property::new("partition of unity", worst < ROUNDING, format!("largest |sum N - 1| {worst:.1e}")).with(worst)
}

/// The largest degree of which all polynomials in the reference coordinates are reproduced.
fn completeness(element: &Element) -> Property {
    let d = element.dimension();
    let samples = samples(element);
    let reproduced = |e: &[i32]| {
        let defect = |at: &[f64]| {
            let nodal = element.positions.chunks_exact(d).zip(&element.functions.values);
            (nodal.map(|(x, n)| monomial(x, e) * n.evaluate(at)).sum::<f64>() - monomial(at, e)).abs()
        };
        samples.chunks_exact(d).all(|at| defect(at) < ROUNDING)
    };
    let holds = |degree: i32| exponents(d, degree).iter().all(|e| reproduced(e));
    let degree = (1..=12).take_while(|&degree| holds(degree)).count();
    Property::new("complete to degree", degree >= 1, degree.to_string()).with(degree as f64)
}

pub fn monomial(x: &[f64], e: &[i32]) -> f64 {
    x.iter().zip(e).map(|(x, e)| x.powi(*e)).product()
}

/// All exponents with the sum `degree`.
pub fn exponents(d: usize, degree: i32) -> Vec<Vec<i32>> {
    if d == 1 {
        return vec![vec![degree]];
    }
    let rest = |first: i32| exponents(d - 1, degree - first).into_iter().map(move |r| [&[first], &r[..]].concat());
    (0..=degree).flat_map(rest).collect()
}

fn gradients(element: &Element) -> Property {
    let mut worst: f64 = 0.0;
    for at in samples(element).chunks_exact(element.dimension()) {
        for (n, gradient) in element.functions.values.iter().zip(&element.functions.gradients) {
            for (k, dn) in gradient.iter().enumerate() {
                let moved = |h: f64| {
                    let mut at = at.to_vec();
                    at[k] += h;
                    n.evaluate(&at)
                };
                let exact = dn.evaluate(at);
                let difference = (moved(STEP) - moved(-STEP)) / (2.0 * STEP);
                // Slopes of about zero are compared absolutely, and large ones relative to their size.
                worst = worst.max((exact - difference).abs() / (1.0 + exact.abs()));
            }
        }
    }
    let finding = format!("largest difference from central differences {worst:.1e}");
    // Differences err by some 1e-10, and a wrong gradient in its first digits: any bound between tells them apart.
    Property::new("gradients", worst < 1e-5, finding).with(worst)
}

fn rule(element: &Element) -> Property {
    let table = &element.tabulation;
    let outside = places(element).iter().filter(|at| !element.cell.contains(at)).count();
    let negative = table.weights.iter().chain(&table.volumetric).filter(|w| **w < 0.0).count();
    let finding = match (outside, negative) {
        (0, 0) => "all points inside the cell, no negative weight".to_string(),
        _ => format!("{outside} points outside the cell, {negative} negative weights"),
    };
    Property::new("quadrature rule", outside + negative == 0, finding)
}

/// The rule compared with one of much higher degree, on the reference cell.
fn degree(element: &Element) -> Property {
    let name = "quadrature degree";
    let stiffness = |table: &Tabulation| {
        let mut geometry = Geometry::new(table);
        geometry.set(table, &element.positions).ok()?;
        Some(geometry.stiffness(Moduli { lambda: 1.0, mu: 1.0 }))
    };
    let with = |degree: usize| {
        let rule = Quadrature::of_degree(element.cell, degree);
        stiffness(&Tabulation::new(&element.functions, &rule, None))
    };
    // What is condensed has gradients that no rule of more points would have.
    let own = Tabulation { modes: None, ..element.tabulation.clone() };
    // The reference is of a higher degree than any that is tried against it.
    let (Some(own), Some(exact)) = (stiffness(&own), with(24)) else {
        return Property::noted(name, "the reference cell has no stiffness");
    };
    let error = |r: &DMatrix<f64>| (r - &exact).norm() / exact.norm();
    let needed = (0..=16).find(|&degree| with(degree).is_some_and(|r| error(&r) < 1e-11));
    let needed = needed.map_or("more than 16".to_string(), |degree| degree.to_string());
    let reached = reached(element);
    let finding = format!("exact to {reached}, R on the reference cell needs {needed}, its error {:.1e}", error(&own));
    let property =
        if error(&own) < 1e-11 { Property::new(name, true, finding) } else { Property::noted(name, finding) };
    property.with(error(&own))
}

/// The positions of the quadrature points, as the linear functions reproduce them.
pub fn places(element: &Element) -> Vec<Vec<f64>> {
    let d = element.dimension();
    let coordinate = |values: &[f64], k: usize| -> f64 {
        values.iter().zip(element.positions.chunks_exact(d)).map(|(n, x)| n * x[k]).sum()
    };
    let values = element.tabulation.values.chunks_exact(element.nodes());
    values.map(|values| (0..d).map(|k| coordinate(values, k)).collect()).collect()
}

/// The largest degree of which the rule integrates every monomial.
fn reached(element: &Element) -> usize {
    let (d, table) = (element.dimension(), &element.tabulation);
    let fine = Quadrature::of_degree(element.cell, 24);
    let places = places(element);
    let exact = |e: &Vec<i32>| {
        let own: f64 = places.iter().zip(&table.weights).map(|(x, w)| w * monomial(x, e)).sum();
        let fine: f64 = fine.points.chunks_exact(d).zip(&fine.weights).map(|(x, w)| w * monomial(x, e)).sum();
        (own - fine).abs() < ROUNDING
    };
    (1..=20).take_while(|&degree| exponents(d, degree).iter().all(exact)).count()
}
