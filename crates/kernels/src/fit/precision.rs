//! One element in another kind of number: in twice the digits, to tell what rounding did, or in half of them.

use super::constrained::bounded_optimum;
use super::input::{check_finite, check_length, check_moduli, check_nodes};
use super::least_squares::normal_equations;
use super::method::Method;
use super::normal::Normal;
use super::settings::Fit;
use super::weight::{Route, Weight};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::material::Moduli;
use crate::scalar::{DoubleDouble, Real};
use crate::springs::Springs;
use crate::stiffness::Geometry;
use crate::symbolic::Differentiable;

/// The constants of one element with every operation in numbers of the kind of `any`, `[springs]`, N/m; nodes at `x`,
/// `[nodes × dimension]`, m. Tabulation and moduli are taken as they are; gradients of springs on functions are known
/// in twice the digits of `f64`. Iterations end where they do in `f64`, and bounds are ignored: [`bounded_constants`] keeps them.
///
/// # Errors
/// An array has a wrong length, a number is not finite or out of its range, the springs are those of another element, the
/// Jacobian is not positive everywhere, the springs are linearly dependent or pull at rest, or the objective needs what is known in
/// `f64` alone.
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
    let constants = match closed_equations(any, element, springs, x, moduli, fit)? {
        Some(mut normal) => normal.solve_regular().then(|| fit.spread_of(springs, &normal.rhs)),
        None => shaped(any, element, springs, x, moduli, fit).and_then(Method::constants),
    };
    let finite = constants.filter(|constants| constants.iter().all(|k| k.rounded().is_finite()));
    finite.ok_or_else(|| no_answer("the springs do not have one optimum, or the element has no stiffness"))
}

/// The normal equations of the unknowns of a fit that has a closed form.
fn closed_equations<T: Real>(
    any: &T,
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    fit: &Fit,
) -> Result<Option<Normal<T>>> {
    let Route::Closed(weight) = fit.objective.route(!springs.functions.is_empty()) else { return Ok(None) };
    let x = differences(any, element.dimension(), x);
    let mut geometry = Geometry::like(any, &element.tabulation);
    if !geometry.update(&element.tabulation, &x) {
        return Err(no_answer("the Jacobian is not positive everywhere"));
    }
    let mut normal = Normal::default();
    normal_equations(weight, springs, &x, &geometry, moduli, &mut normal);
    Ok(Some(normal.by_unknowns(springs, fit.tied)))
}

/// The constants of a fit under `k ≥ 0` in twice the digits, `[springs]`, N/m, if it is the constants above zero of `near` that the
/// optimum has there: `∂f/∂k` is zero for those and not below zero for the others. `None` where it is not.
///
/// # Errors
/// Those of [`constants_of_kind`]; the objective is spectral, whose optimum is proved by [`distance_from_optimum`].
pub fn bounded_constants(
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    fit: &Fit,
    near: &[f64],
) -> Result<Option<Vec<DoubleDouble>>> {
    check(element, springs, x, moduli)?;
    fit.check_constants_alone()?;
    check_length("near", near.len(), springs.len())?;
    check_finite("near", near)?;
    if springs.is_empty() {
        return Ok(Some(Vec::new()));
    }
    let any = DoubleDouble::from(0.0);
    if let Some(normal) = closed_equations(&any, element, springs, x, moduli, fit)? {
        let mut of_unknowns = vec![0.0; normal.size()];
        near.iter().enumerate().for_each(|(s, k)| of_unknowns[if fit.tied { springs.groups[s] } else { s }] = *k);
        let k = bounded_optimum(&normal, &of_unknowns)
            .ok_or_else(|| no_answer("the springs that are not zero are linearly dependent"))?;
        return Ok(k.map(|k| fit.spread_of(springs, &k)));
    }
    shaped(&any, element, springs, x, moduli, fit)
        .and_then(|method| method.bounded_constants(near))
        .ok_or_else(|| no_answer("the springs do not have one optimum, or the element has no stiffness"))
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
    let distance = shaped(&DoubleDouble::from(0.0), element, springs, x, moduli, fit)
        .and_then(|mut method| method.distance_from_optimum(constants, value))
        .filter(|distance| !distance.is_nan());
    distance.ok_or_else(|| no_answer("it is not proved that the constants reach the value"))
}

/// [`solved`] for the element with nodes at `x`; None also if that has no stiffness or its springs no gradients.
fn shaped<T: Real>(
    any: &T,
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    fit: &Fit,
) -> Option<Method<T>> {
    let precise = differences(&DoubleDouble::from(0.0), element.dimension(), x);
    let x = differences(any, element.dimension(), x);
    let mut geometry = Geometry::like(any, &element.tabulation);
    if !geometry.update(&element.tabulation, &x) {
        return None;
    }
    let known = |g: DoubleDouble| any.constant(&g.hi) + &any.constant(&g.lo);
    let measured: Vec<T> = measured(springs, &precise)?.into_iter().map(known).collect();
    solved(springs, &x, &geometry, moduli, &measured, fit)
}

/// The gradients of the springs on functions, `[functions × nodes·dimension]`; None if one is zero or not finite.
pub(super) fn measured<T: Differentiable>(springs: &Springs, x: &[T]) -> Option<Vec<T>> {
    let mut rows = vec![T::from(0.0); springs.functions.len() * x.len()];
    springs.function_gradients(x, &mut rows).then_some(rows)
}

/// The objective solved for one element in numbers of the kind of `x`, `measured` as [`Method::solve`] needs it; None if it does not
/// need the reduced element.
pub(super) fn solved<T: Real>(
    springs: &Springs,
    x: &[T],
    geometry: &Geometry<T>,
    moduli: &Moduli,
    measured: &[T],
    fit: &Fit,
) -> Option<Method<T>> {
    let mut method = Method::like(&x[0], springs, fit)?;
    method.solve(springs, x, geometry, moduli, measured);
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
