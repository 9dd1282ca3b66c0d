//! One element in another kind of number: in double-double numbers, to measure the effect of rounding, or in `f32`.
//!
//! Theory: page *Precision* of the book.

use super::constrained::bounded_optimum;
use super::input::{check_finite, check_length, check_moduli, check_nodes};
use super::least_squares::normal_equations;
use super::method::Method;
use super::normal::Normal;
use super::reduction::Source;
use super::rows::Rows;
use super::settings::Fit;
use super::weight::{ClosedWeight, Route, Weight};
use crate::element::{Element, Tabulation};
use crate::error::{Error, ErrorKind, Result};
use crate::material::{Hooke, Moduli};
use crate::scalar::{DoubleDouble, Real, Scalar};
use crate::springs::Springs;
use crate::stiffness::Geometry;
use crate::symbolic::Differentiable;

/// The constants of one element with every operation in numbers of the kind of `any`, `[springs]`, N/m; nodes at `x`,
/// `[nodes × dimension]`, m. Tabulation and moduli are used as given, and the gradients of springs on functions are
/// computed in double-double numbers. Iterations end by the same criteria as in `f64`. Bounds are ignored:
/// [`bounded_constants`] respects them.
///
/// # Errors
/// An array has a wrong length; a number is not finite or is out of its range; the springs belong to another element;
/// the Jacobian is not positive everywhere; the springs are linearly dependent or pull at rest; or the objective
/// requires what is implemented in `f64` only.
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

/// [`constants_of_kind`] in double-double numbers. As it has no parameters of type it is compiled in this package, which is optimised, whoever
/// calls it.
///
/// # Errors
/// Those of [`constants_of_kind`].
pub fn double_double_constants(
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    fit: &Fit,
) -> Result<Vec<DoubleDouble>> {
    constants_of_kind(&DoubleDouble::from(0.0), element, springs, x, moduli, fit)
}

/// [`constants_of_kind`] in `f32`, compiled as [`double_double_constants`].
///
/// # Errors
/// Those of [`constants_of_kind`].
pub fn single_constants(
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    fit: &Fit,
) -> Result<Vec<f32>> {
    constants_of_kind(&0f32, element, springs, x, moduli, fit)
}

/// The constants of one element in any kind of number, such as `f32` or exact rationals; nodes at `x`,
/// `[nodes × dimension]`.
///
/// # Errors
/// The springs and the table differ in their numbers of nodes or dimensions; `x` has another length; the weight is
/// `relative` or springs measure functions, both of which require roots; the Jacobian is not positive everywhere; or
/// the springs are linearly dependent.
pub fn constants_in<T: Scalar>(
    weight: Weight,
    springs: &Springs,
    table: &Tabulation<T::Constant>,
    x: &[T],
    moduli: &Moduli<T::Constant>,
) -> Result<Vec<T>> {
    // What requires roots is refused before anything is computed: rational numbers have none.
    let weight = weight.closed(springs.need_matrix())?;
    if (table.nodes, table.dimension) != (springs.nodes(), springs.dimension()) {
        let expected = format!("a table of {} nodes in {} dimensions", springs.nodes(), springs.dimension());
        return Err(Error::expected("table", expected, format!("{} in {}", table.nodes, table.dimension)));
    }
    check_length("x", x.len(), springs.nodes() * springs.dimension())?;
    let mut geometry = Geometry::like(&x[0], table);
    if !geometry.update(table, x) {
        return Err(no_answer("the Jacobian is not positive everywhere"));
    }
    let mut normal = Normal::default();
    normal_equations(weight, springs, x, &geometry, &Hooke::Isotropic(moduli.of_kind(&x[0])), &mut normal);
    // NaN is not equal to itself plus one.
    let is_finite = |k: &T| (k.one() + &(k.clone() - k)).exceeds(&k.zero());
    if !(normal.solve_regular() && normal.rhs.iter().all(is_finite)) {
        return Err(no_answer("the springs are linearly dependent"));
    }
    Ok(normal.rhs)
}

/// The normal equations of the unknowns of a fit with a closed form.
fn closed_equations<T: Real>(
    any: &T,
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    fit: &Fit,
) -> Result<Option<Normal<T>>> {
    let weight = match fit.objective.route(springs.need_matrix()) {
        Route::Closed(weight) => weight,
        Route::Blocks => ClosedWeight::OffDiagonal,
        Route::Reduced(_) => return Ok(None),
    };
    let normal = equations(any, element, springs, x, moduli, weight)?;
    Ok(Some(normal.by_unknowns(springs, fit.tied)))
}

/// The normal equations of all springs under this weight.
fn equations<T: Real>(
    any: &T,
    element: &Element,
    springs: &Springs,
    x: &[f64],
    moduli: &Moduli,
    weight: ClosedWeight,
) -> Result<Normal<T>> {
    let precise = differences(&DoubleDouble::from(0.0), element.dimension(), x);
    let x = differences(any, element.dimension(), x);
    let mut geometry = Geometry::like(any, &element.tabulation);
    if !geometry.update(&element.tabulation, &x) {
        return Err(no_answer("the Jacobian is not positive everywhere"));
    }
    let hooke = Hooke::Isotropic(*moduli).of_kind(any);
    if !springs.need_matrix() {
        let mut normal = Normal::default();
        normal_equations(weight, springs, &x, &geometry, &hooke, &mut normal);
        return Ok(normal);
    }
    let measured = known(any, measured(springs, &precise))
        .ok_or_else(|| no_answer("what one of the springs measures has no finite gradient other than zero"))?;
    let rows = Rows::of_gradients(springs, &x, &geometry, measured);
    Ok(rows.normal(weight, &x, &geometry.entries(&hooke)))
}

/// Numbers of more digits in those of the kind of `any`.
fn known<T: Real>(any: &T, values: Option<Vec<DoubleDouble>>) -> Option<Vec<T>> {
    // A kind of more digits than those of one double keeps both parts.
    let known = |g: DoubleDouble| any.constant(&g.hi) + &any.constant(&g.lo);
    Some(values?.into_iter().map(known).collect())
}

/// The constants of a fit under `k ≥ 0` in double-double numbers, `[springs]`, N/m, if the optimum has the same
/// positive constants as `near`: `∂f/∂k` is zero for those and not negative for the others. `None` otherwise.
///
/// # Errors
/// Those of [`constants_of_kind`]; or the objective is spectral, whose optimum is proved by [`distance_from_optimum`].
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
    // Without springs nothing is to be compared.
    if springs.is_empty() {
        return Ok(Some(Vec::new()));
    }
    let any = DoubleDouble::from(0.0);
    if let Some(normal) = closed_equations(&any, element, springs, x, moduli, fit)? {
        let mut of_unknowns = vec![0.0; normal.size()];
        near.iter().enumerate().for_each(|(s, k)| of_unknowns[if fit.tied { springs.groups()[s] } else { s }] = *k);
        let k = bounded_optimum(&normal, &of_unknowns)
            .ok_or_else(|| no_answer("the springs that are not zero are linearly dependent"))?;
        return Ok(k.map(|k| fit.spread_of(springs, &k)));
    }
    shaped(&any, element, springs, x, moduli, fit)
        .and_then(|method| method.bounded_constants(near))
        .ok_or_else(|| no_answer("the springs do not have one optimum, or the element has no stiffness"))
}

/// The error for a problem without an answer in this kind of number.
pub(super) fn no_answer(problem: &str) -> Error {
    Error::new(problem).of_kind(ErrorKind::Infeasible)
}

/// Checks one element with nodes at `x`, `[nodes × dimension]`.
fn check(element: &Element, springs: &Springs, x: &[f64], moduli: &Moduli) -> Result<()> {
    springs.check(element)?;
    check_moduli(moduli, element.dimension())?;
    check_nodes(element, element.dimension(), x)
}

/// An upper bound of the distance of the constants of a spectral fit from the optimum, relative to the stated `value`
/// (N/m), proved in double-double numbers: that the constants reach the value, by the pivots of `value I ± (R − K)`,
/// and that none reach less than the bound, by the dual pair.
///
/// # Errors
/// An array has a wrong length; a number is not finite or is out of its range; the springs belong to another element;
/// the objective is another; or the proof fails.
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

/// Solves the objective as [`solved`] does, for the element with nodes at `x`; None also if it has no stiffness or its springs have no
/// gradients.
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
    let measured = known(any, measured(springs, &precise))?;
    solved(springs, &x, &geometry, &Hooke::Isotropic(*moduli), &measured, fit)
}

/// The gradients of the springs on functions, `[functions × nodes·dimension]`; None if one is zero or not finite.
pub(super) fn measured<T: Differentiable>(springs: &Springs, x: &[T]) -> Option<Vec<T>> {
    let mut rows = vec![T::from(0.0); springs.functions().len() * x.len()];
    springs.function_gradients(x, &mut rows).then_some(rows)
}

/// The objective solved for one element in numbers of the kind of `x`, with `measured` as [`Method::solve`] requires
/// it; None if the objective does not require the reduced element.
pub(super) fn solved<T: Real>(
    springs: &Springs,
    x: &[T],
    geometry: &Geometry<T>,
    hooke: &Hooke,
    measured: &[T],
    fit: &Fit,
) -> Option<Method<T>> {
    let mut method = Method::like(&x[0], springs, fit)?;
    method.solve(springs, x, Source::Element(geometry, &hooke.of_kind(&x[0])), measured);
    Some(method)
}

/// The condition number of the normal equations of an element, scaled to a unit diagonal: the ratio of the largest to
/// the least eigenvalue. A relative change of the shape or the stiffness changes the constants by at most about this
/// factor.
///
/// # Errors
/// An array has a wrong length; a number is not finite or is out of its range; the springs belong to another element;
/// the equations have no closed form or are singular; or the element has no stiffness.
pub fn condition(weight: Weight, element: &Element, springs: &Springs, x: &[f64], moduli: &Moduli) -> Result<f64> {
    check(element, springs, x, moduli)?;
    let normal = equations(&0.0, element, springs, x, moduli, weight.closed(false)?)?;
    let (scaled, _) = normal.scaled();
    let m = scaled.size();
    let eigenvalues = springfit_numerics::dense::eigenvalues(nalgebra::DMatrix::from_vec(m, m, scaled.gram));
    let (least, largest) = (eigenvalues.min(), eigenvalues.max());
    // An eigenvalue below rounding of the largest has no meaning.
    let is_regular = least > m as f64 * f64::EPSILON * largest;
    if is_regular { Ok(largest / least) } else { Err(no_answer("the springs are linearly dependent")) }
}

/// The nodes relative to the first one, which is exact if they are near each other.
pub(super) fn differences<T: Real>(any: &T, dimension: usize, x: &[f64]) -> Vec<T> {
    x.iter().enumerate().map(|(i, v)| any.constant(v) - &any.constant(&x[i % dimension])).collect()
}
