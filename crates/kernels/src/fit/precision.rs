//! One element in another kind of number: in twice the digits, to tell what rounding did, or in half of them.

use super::least_squares::normal_equations;
use super::method::Method;
use super::normal::Normal;
use super::{Fit, Weight, constants_in};
use crate::element::Element;
use crate::material::Moduli;
use crate::scalar::{DoubleDouble, Real};
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// The constants of one element with every operation in numbers of the kind of `any`, `[springs]`, N/m; nodes at `x`,
/// `[nodes × dimension]`, m. Tabulation and moduli are taken as they are; of springs on functions the gradients are known in
/// `f64` alone. Iterations end where they do in `f64`, and no bound is kept.
///
/// None if the Jacobian is not positive everywhere or the springs are linearly dependent.
pub fn constants_of_kind<T: Real>(
    any: &T,
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    fit: &Fit,
) -> Option<Vec<T>> {
    let x = differences(any, element.dimension(), x);
    match shaped(element, springs, &x, moduli, fit)? {
        Some(method) => method.constants(),
        None => constants_in(fit.objective.weight()?, springs, &element.tabulation, &x, moduli),
    }
}

/// How far the constants of a spectral fit are from the optimum at most, relative to the `value` (N/m) that is said of them, proved
/// in twice the digits: that they reach it, by the pivots of `value I ± (R − K)`, and that nothing reaches less than the bound,
/// by the dual pair. None if that fails, or the objective is another.
pub fn distance_from_optimum(
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    fit: &Fit,
    (constants, value): (&[f64], f64),
) -> Option<f64> {
    let x = differences(&DoubleDouble::from(0.0), element.dimension(), x);
    shaped(element, springs, &x, moduli, fit)??.distance_from_optimum(constants, value)
}

/// [`solved`] for the element with nodes at `x`; None if that has no stiffness or its springs no gradients.
fn shaped<T: Real>(
    element: &Element,
    springs: &Springs,
    x: &[T],
    moduli: &Moduli,
    fit: &Fit,
) -> Option<Option<Method<T>>> {
    let mut geometry = Geometry::like(x.first()?, &element.tabulation);
    if !geometry.update(&element.tabulation, x) {
        return None;
    }
    let plain: Vec<f64> = x.iter().map(Real::rounded).collect();
    let mut measured = vec![0.0; springs.functions.len() * plain.len()];
    springs.function_gradients(&plain, &mut measured).then(|| solved(springs, x, &geometry, moduli, &measured, fit))
}

/// The objective solved for one element in numbers of the kind of `x`, `measured` as [`Method::solve`] needs it; None if it has a
/// closed form.
pub(super) fn solved<T: Real>(
    springs: &Springs,
    x: &[T],
    geometry: &Geometry<T>,
    moduli: &Moduli,
    measured: &[f64],
    fit: &Fit,
) -> Option<Method<T>> {
    let mut method = Method::like(&x[0], springs, fit)?;
    let measured: Vec<T> = measured.iter().map(|g| x[0].constant(g)).collect();
    method.solve(springs, x, geometry, moduli, &measured);
    Some(method)
}

/// The ratio of the largest to the least eigenvalue of the normal equations of an element, scaled to a unit diagonal; what a
/// relative change of the shape or the stiffness does to the constants is at most about so many times as large. `None` where they
/// are singular, the element has no stiffness, or the springs measure functions.
pub fn condition(weight: Weight, element: &Element, springs: &Springs, x: &[f64], moduli: &Moduli) -> Option<f64> {
    if !springs.functions.is_empty() || weight == Weight::Relative {
        return None;
    }
    let x = differences(&0.0, element.dimension(), x);
    let mut geometry = Geometry::new(&element.tabulation);
    geometry.set(&element.tabulation, &x).ok()?;
    let mut normal = Normal::default();
    normal_equations(weight, springs, &x, &geometry, moduli, &mut normal);
    let (scaled, _) = normal.scaled();
    let m = scaled.size();
    let eigenvalues = nalgebra::DMatrix::from_vec(m, m, scaled.gram).symmetric_eigenvalues();
    let (least, largest) = (eigenvalues.min(), eigenvalues.max());
    // Below rounding of the largest the least says nothing.
    (least > m as f64 * f64::EPSILON * largest).then(|| largest / least)
}

/// The nodes from the first, which is exact where they are near each other.
pub(super) fn differences<T: Real>(any: &T, dimension: usize, x: &[f64]) -> Vec<T> {
    x.iter().enumerate().map(|(i, v)| any.constant(v) - &any.constant(&x[i % dimension])).collect()
}
