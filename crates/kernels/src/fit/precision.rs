//! One element in another kind of number: in twice the digits, to tell what rounding did, or in half of them.

use super::input::{check_finite, check_length, check_moduli, check_nodes};
use super::least_squares::constants_in;
use super::least_squares::normal_equations;
use super::method::Method;
use super::normal::Normal;
use super::objective::Objective;
use super::settings::Fit;
use super::weight::{Route, Weight};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::material::Moduli;
use crate::scalar::{DoubleDouble, Real};
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// The constants of one element with every operation in numbers of the kind of `any`, `[springs]`, N/m; nodes at `x`,
/// `[nodes × dimension]`, m. Tabulation and moduli are taken as they are; of springs on functions the gradients are known in
/// `f64` alone. Iterations end where they do in `f64`, and no bound is kept.
///
/// # Errors
/// An array has a wrong length, a number is not finite or out of its range, the springs are those of another element, the
/// Jacobian is not positive everywhere, the springs are linearly dependent or pull at rest, or the objective needs what is known in `f64` alone.
pub fn constants_of_kind<T: Real>(
    any: &T,
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    fit: &Fit,
) -> Result<Vec<T>> {
    check(element, springs, x, moduli)?;
    fit.check_constants_alone()?;
    let x = differences(any, element.dimension(), x);
    let constants = match fit.objective {
        Objective::Frobenius(weight) if matches!(weight.route(!springs.functions.is_empty()), Route::Closed(_)) => {
            return constants_in(weight, springs, &element.tabulation, &x, moduli);
        }
        Objective::Frobenius(_) | Objective::Spectral(_) | Objective::Divergence(_) => {
            shaped(element, springs, &x, moduli, fit).and_then(Method::constants)
        }
    };
    let finite = constants.filter(|constants| constants.iter().all(|k| k.rounded().is_finite()));
    finite.ok_or_else(|| no_answer("the springs do not have one optimum, or the element has no stiffness"))
}

/// What has no answer in this kind of number.
pub(super) fn no_answer(problem: &str) -> Error {
    Error::new(problem).of_kind(ErrorKind::Infeasible)
}

/// One element with nodes at `x`, `[nodes × dimension]`.
fn check(element: &Element, springs: &Springs, x: &[f64], moduli: &Moduli) -> Result<()> {
    springs.check(element)?;
    check_moduli(moduli, element.dimension())?;
    check_nodes(element, element.dimension(), x)
}

/// How far the constants of a spectral fit are from the optimum at most, relative to the `value` (N/m) that is said of them, proved
/// in twice the digits: that they reach it, by the pivots of `value I ± (R − K)`, and that nothing reaches less than the bound,
/// by the dual pair.
///
/// # Errors
/// An array has a wrong length, a number is not finite or out of its range, the springs are those of another element, the
/// objective is another, or the proof fails.
pub fn distance_from_optimum(
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    fit: &Fit,
    (constants, value): (&[f64], f64),
) -> Result<f64> {
    check(element, springs, x, moduli)?;
    check_length("constants", constants.len(), springs.len())?;
    check_finite("constants", constants)?;
    check_finite("value", &[value])?;
    let x = differences(&DoubleDouble::from(0.0), element.dimension(), x);
    let distance = shaped(element, springs, &x, moduli, fit)
        .and_then(|mut method| method.distance_from_optimum(constants, value))
        .filter(|distance| !distance.is_nan());
    distance.ok_or_else(|| no_answer("it is not proved that the constants reach the value"))
}

/// [`solved`] for the element with nodes at `x`; None also if that has no stiffness or its springs no gradients.
fn shaped<T: Real>(element: &Element, springs: &Springs, x: &[T], moduli: &Moduli, fit: &Fit) -> Option<Method<T>> {
    let mut geometry = Geometry::like(x.first()?, &element.tabulation);
    if !geometry.update(&element.tabulation, x) {
        return None;
    }
    let plain: Vec<f64> = x.iter().map(Real::rounded).collect();
    let mut measured = vec![0.0; springs.functions.len() * plain.len()];
    let is_measured = springs.function_gradients(&plain, &mut measured);
    is_measured.then(|| solved(springs, x, &geometry, moduli, &measured, fit)).flatten()
}

/// The objective solved for one element in numbers of the kind of `x`, `measured` as [`Method::solve`] needs it; None if it does not
/// need the reduced element.
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
/// relative change of the shape or the stiffness does to the constants is at most about so many times as large.
///
/// # Errors
/// An array has a wrong length, a number is not finite or out of its range, the springs are those of another element, the
/// equations have no closed form or are singular, or the element has no stiffness.
pub fn condition(weight: Weight, element: &Element, springs: &Springs, x: &[f64], moduli: &Moduli) -> Result<f64> {
    check(element, springs, x, moduli)?;
    let weight = weight.closed(!springs.functions.is_empty())?;
    let x = differences(&0.0, element.dimension(), x);
    let mut geometry = Geometry::new(&element.tabulation);
    geometry.set(&element.tabulation, &x).map_err(|fault| no_answer(&fault.to_string()))?;
    let mut normal = Normal::default();
    normal_equations(weight, springs, &x, &geometry, moduli, &mut normal);
    let (scaled, _) = normal.scaled();
    let m = scaled.size();
    let eigenvalues = nalgebra::DMatrix::from_vec(m, m, scaled.gram).symmetric_eigenvalues();
    let (least, largest) = (eigenvalues.min(), eigenvalues.max());
    // Below rounding of the largest the least says nothing.
    let is_regular = least > m as f64 * f64::EPSILON * largest;
    if is_regular { Ok(largest / least) } else { Err(no_answer("the springs are linearly dependent")) }
}

/// The nodes from the first, which is exact where they are near each other.
pub(super) fn differences<T: Real>(any: &T, dimension: usize, x: &[f64]) -> Vec<T> {
    x.iter().enumerate().map(|(i, v)| any.constant(v) - &any.constant(&x[i % dimension])).collect()
}
