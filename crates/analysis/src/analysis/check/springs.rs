//! The springs of an element: its exact network, mechanisms, the condition number of their equations, and the resulting
//! moduli.

use super::property::Property;
use super::shape::{ASKED, deformations, geometry, rank, shapes};
use crate::analysis::moduli::Lattice;
use crate::element::Element;
use crate::error::Result;
use crate::fit::{ExactFit, Fit, Objective, Weight, element_errors, fit_element, fit_exact, reference_fit};
use crate::material::{Hooke, Material};
use crate::springs::Springs;
use nalgebra::DMatrix;
use std::sync::Arc;

/// The `‖R − K‖/‖R‖` of an exact network that rounding may cause.
// The shipped elements leave 6e-16 at most. A term that is wrong or lacking changes the first digits.
const EXACT: f64 = 1e-10;
/// The difference of two networks, relative to `‖R‖`, that rounding of the normal equations may cause.
// The shipped elements, with conditions of the equations of up to some hundred, leave 2e-14 at most.
const FORMULA: f64 = 1e-8;
/// An element with more springs than this is compared at one shape, for which the formula takes a second.
// Of the shipped elements the 352 springs of `hex27` take two seconds at that shape, and the 67 of `quad12`
// milliseconds.
const MANY: usize = 40;

pub fn properties(element: &Arc<Element>) -> Vec<Property> {
    let mut properties = vec![exact(element)];
    properties.extend(selected(element));
    properties
}

/// The network that is equal to the finite element: its tangent at rest compared with R, over all shapes.
fn exact(element: &Element) -> Property {
    if element.modes() > 0 {
        return Property::noted("exact network", "none: the element has functions that belong to no node");
    }
    let (young, poisson) = ASKED;
    let cell: Vec<usize> = (0..element.nodes()).collect();
    let (mut worst, mut negative, mut pairs) = (0.0f64, 0, 0);
    for x in shapes(element) {
        let found = Material::for_body(element.dimension(), young, poisson, None, None).and_then(|material| {
            let fits = fit_exact(element, &x, &cell, material, &ExactFit::default(), &mut |_| {})?;
            let errors = element_errors(element, &x, &cell, material.moduli(), &fits)?;
            Ok((fits, errors.frobenius[0]))
        });
        match found {
            Ok((fits, error)) => {
                let edges = &fits.constants[..fits.springs.pairs().len()];
                worst = worst.max(error);
                negative += edges.iter().filter(|k| **k < 0.0).count();
                pairs += edges.len();
            }
            Err(error) => return Property::new("exact network", false, error.to_string()),
        }
    }
    let finding = format!("largest |R - K|/|R| {worst:.1e}, {negative} of {pairs} edges with k < 0");
    Property::new("exact network", worst <= EXACT, finding).with(worst)
}

/// The properties of the groups that are not optional.
fn selected(element: &Arc<Element>) -> Vec<Property> {
    let springs = match Springs::select(element, None) {
        Ok(springs) if springs.is_empty() => return vec![Property::noted("springs", "none that are not optional")],
        Ok(springs) => springs,
        Err(error) => return vec![Property::new("springs", false, error.to_string())],
    };
    let (rank, condition) = rank_and_condition(element, &springs);
    let mut properties = vec![rank, condition, formula(element, &springs)];
    let every: Vec<String> = element.springs.iter().map(|g| g.name.clone()).collect();
    properties.push(moduli(element, "moduli of the springs", &springs));
    if element.springs.iter().any(|g| g.optional)
        && let Ok(all) = Springs::select(element, Some(&every))
    {
        properties.push(moduli(element, "with optional springs", &all));
    }
    properties
}

/// The rank of the g_s, and the condition number of `M_st = (g_s·g_t)²` scaled to a unit diagonal, over all shapes.
fn rank_and_condition(element: &Element, springs: &Springs) -> (Property, Property) {
    let expected = deformations(element);
    let (mut least, mut worst) = (expected, 0.0f64);
    for x in shapes(element) {
        let mut g = Vec::new();
        springs.gradients(&x, &geometry(element, &x), &mut g);
        if !springs.function_gradients(&x, &mut vec![0.0; springs.functions().len() * x.len()]) {
            let finding = "a spring's measure has no finite gradient other than zero";
            let rank = Property::new("rank of the springs", false, finding);
            return (rank, Property::noted("condition of the equations", "not looked at"));
        }
        let mut rows = DMatrix::from_row_slice(springs.len(), x.len(), &g);
        rows.row_iter_mut().for_each(|mut row| {
            let size = row.norm();
            row /= size;
        });
        let singular = (rows.transpose() * &rows).symmetric_eigenvalues();
        // A square of singular values: what is below the limit is rounding.
        least = least.min(singular.iter().filter(|s| **s > 1e-12 * singular.amax()).count());
        // The product of `g_s g_sᵀ` and `g_t g_tᵀ` is the square of `g_s · g_t`, which is the square of a cosine of
        // unit rows.
        let gram = (&rows * rows.transpose()).map(|c| c * c).symmetric_eigenvalues();
        worst = worst.max(if gram.min() > 0.0 { gram.max() / gram.min() } else { f64::INFINITY });
    }
    let mechanisms = expected - least;
    let finding = format!("{least} of {expected}, {mechanisms} mechanisms");
    let rank = Property::new("rank of the springs", mechanisms == 0, finding).with(mechanisms as f64);
    // Beyond it less than two of sixteen digits are left, and the least eigenvalue itself is rounding.
    let finding = if worst < 1e14 {
        format!("{worst:.1} at worst, scaled to a unit diagonal")
    } else {
        "singular: the springs are linearly dependent, and the least of all optima is taken".to_string()
    };
    (rank, Property::noted("condition of the equations", finding).with(worst))
}

/// The constants of every weight against those of the formula, by the matrices of the springs.
fn formula(element: &Element, springs: &Springs) -> Property {
    let name = "fits by the formula";
    match difference_from_formula(element, springs) {
        Ok(Some(worst)) => {
            let finding = format!("networks of every weight, difference {worst:.1e} of weighted R");
            Property::new(name, worst <= FORMULA, finding).with(worst)
        }
        // The energy that the relative error is relative to vanishes in a spurious mode.
        Ok(None) => Property::noted(name, "not compared: R has spurious modes"),
        Err(error) => Property::new(name, false, error.to_string()),
    }
}

/// The largest difference of two networks over all shapes, or at one shape where springs are many; `None` if R has spurious modes.
fn difference_from_formula(element: &Element, springs: &Springs) -> Result<Option<f64>> {
    let (young, poisson) = ASKED;
    let moduli = Material::for_body(element.dimension(), young, poisson, None, None)?.moduli();
    let hooke = Hooke::from(moduli);
    let count = if springs.len() > MANY { 1 } else { usize::MAX };
    let mut worst = 0.0f64;
    for x in shapes(element).into_iter().take(count) {
        let r = reference_fit::stiffness(element, &x, &hooke)?;
        if rank(&r) < deformations(element) {
            return Ok(None);
        }
        let g = reference_fit::gradients(element, springs, &x)?;
        for weight in Weight::all() {
            let fast = fit_element(element, springs, &x, moduli, &Fit::new(Objective::Frobenius(weight)))?;
            let formula = reference_fit::constants(element, springs, &x, &hooke, weight)?;
            let change: Vec<f64> = fast.iter().zip(&formula).map(|(a, b)| a - b).collect();
            let seen = reference_fit::seen(weight, &r, &x, element.dimension());
            let difference = seen(&reference_fit::network(&g, &change)).norm() / seen(&r).norm();
            // What is not a number is no agreement.
            if !(difference <= worst) {
                worst = difference;
            }
        }
    }
    Ok(Some(worst))
}

/// The moduli of the plain fit on a periodic box.
fn moduli(element: &Arc<Element>, name: &'static str, springs: &Springs) -> Property {
    let (young, poisson) = ASKED;
    let d = element.dimension();
    let fit = Fit::new(Objective::Frobenius(Weight::None));
    let lattice = Material::for_body(d, young, poisson, None, None)
        .and_then(|material| Lattice::fit(element, springs, &vec![1.0; d], material, &fit));
    let lattice = match lattice {
        Ok(lattice) => lattice,
        Err(e) => return Property::noted(name, format!("none on a box: {}", e.problem())),
    };
    match lattice.of_springs() {
        None => Property::noted(name, "some uniform strain meets no resistance"),
        Some(m) => {
            let finding = format!(
                "frobenius: E {:.3}, nu {:.3}, Zener {:.3}, asked {young}, {poisson}, 1",
                m.young, m.poisson, m.zener
            );
            Property::noted(name, finding).with(m.young)
        }
    }
}
