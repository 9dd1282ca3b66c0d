//! The checks that the public functions of the fits make once, before any cell is computed.

use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{BlockValues, Hooke, Moduli};
use crate::springs::Springs;

/// The number of values that are checked without a branch between them.
const BLOCK: usize = 64;

/// The rounding error of moduli near the bounds of Poisson's ratio, relative to the larger modulus. Moduli that a user
/// has computed from E and ν = −1 or 1/2 meet a bound only up to rounding.
const ROUNDING: f64 = 1e-9;

/// Checks cells with nodes `connectivity`, `[cells × nodes]`, among `points`, `[points × space]`, m.
///
/// # Errors
/// A length is not a multiple of the element's, a coordinate is not finite, or a node is not among the points.
pub fn check_cells(element: &Element, points: &[f64], connectivity: &[usize]) -> Result<()> {
    let (n, space) = (element.nodes(), element.space());
    if !points.len().is_multiple_of(space) {
        return Err(Error::expected("points", format!("{space} coordinates of each point"), points.len()));
    }
    check_finite("points", points)?;
    if !connectivity.len().is_multiple_of(n) {
        return Err(Error::expected("connectivity", format!("{n} nodes of each cell"), connectivity.len()));
    }
    let count = points.len() / space;
    // The sign bits of count − 1 − node and of the node: sums without a branch, which can be vectorised.
    let last = count.wrapping_sub(1);
    let signs = connectivity.iter().fold(last, |signs, node| signs | last.wrapping_sub(*node) | node);
    if signs > usize::MAX / 2
        && let Some(place) = connectivity.iter().position(|node| *node >= count)
    {
        let (expected, found) = (format!("a node below {count}"), connectivity[place]);
        return Err(Error::expected(format!("connectivity[{place}]"), expected, found));
    }
    Ok(())
}

/// Checks a single element with nodes at `x`, `[nodes × dimension]`, m.
///
/// # Errors
/// The length differs, or a coordinate is not finite.
pub fn check_nodes(element: &Element, dimension: usize, x: &[f64]) -> Result<()> {
    check_length("x", x.len(), element.nodes() * dimension)?;
    check_finite("x", x)
}

/// Checks the length of an array.
///
/// # Errors
/// The length differs.
pub fn check_length(key: &str, found: usize, expected: usize) -> Result<()> {
    if found == expected { Ok(()) } else { Err(Error::expected(key, format!("{expected} numbers"), found)) }
}

/// Checks that all values are finite.
///
/// # Errors
/// A value is not finite.
pub fn check_finite(key: &str, values: &[f64]) -> Result<()> {
    match first_other(values, |value| value.is_finite()) {
        Some(place) => Err(Error::expected(format!("{key}[{place}]"), "a finite number", values[place])),
        None => Ok(()),
    }
}

/// Checks that no strain has a negative energy: `μ ≥ 0` and `d λ + 2 μ ≥ 0` in d dimensions, and not both zero.
///
/// # Errors
/// The moduli are not finite, or violate these conditions.
pub fn check_moduli(moduli: &Moduli, dimension: usize) -> Result<()> {
    let Moduli { lambda, mu } = *moduli;
    let size = lambda.abs().max(mu.abs());
    let is_stable = mu >= 0.0 && dimension as f64 * lambda + 2.0 * mu >= -ROUNDING * size;
    if !(size > 0.0 && lambda.is_finite() && mu.is_finite() && is_stable) {
        let expected = format!("mu >= 0 and {dimension} lambda + 2 mu >= 0, finite and not both 0");
        return Err(Error::expected("moduli", expected, format!("lambda = {lambda:?}, mu = {mu:?}")));
    }
    Ok(())
}

/// Checks that no strain has a negative energy; an anisotropic law is proved where it is made.
///
/// # Errors
/// Those of [`check_moduli`]; or the law is one of another dimension, or of cells of a surface or curve in space.
pub fn check_hooke(hooke: &Hooke, element: &Element) -> Result<()> {
    match hooke {
        Hooke::Isotropic(moduli) => check_moduli(moduli, element.dimension()),
        Hooke::Anisotropic(stiffness) if stiffness.dimension() != element.dimension() => {
            let expected = format!("that of a body of {} dimensions", element.dimension());
            Err(Error::expected("stiffness", expected, stiffness.dimension()))
        }
        Hooke::Anisotropic(_) if element.space() != element.dimension() => {
            let expected = "an isotropic law on surfaces and curves in space";
            Err(Error::expected("stiffness", expected, "an anisotropic one").of_kind(ErrorKind::Unsupported))
        }
        Hooke::Anisotropic(_) => Ok(()),
    }
}

/// Checks the cells, springs and moduli of one fit.
///
/// # Errors
/// Those of [`check_cells`], [`check_moduli`] and [`Springs::check`].
pub fn check_fit(
    element: &Element,
    springs: &Springs,
    points: &[f64],
    connectivity: &[usize],
    hooke: &BlockValues<Hooke>,
) -> Result<()> {
    springs.check(element)?;
    hooke.check("moduli", connectivity.len() / element.nodes())?;
    hooke.values().iter().try_for_each(|hooke| check_hooke(hooke, element))?;
    check_cells(element, points, connectivity)
}

/// The index of the first value that fails the test.
fn first_other<T>(values: &[T], test: impl Fn(&T) -> bool) -> Option<usize> {
    let passes = |block: &[T]| block.iter().fold(true, |all, value| all & test(value));
    let block = values.chunks(BLOCK).position(|block| !passes(block))?;
    values[block * BLOCK..].iter().position(|value| !test(value)).map(|place| block * BLOCK + place)
}
