//! The springs of exact networks in other kinds of numbers, for studies of rounding.

use super::kernel::edges;
use crate::element::Element;
use crate::error::Result;
use crate::fit::input::{check_finite, check_nodes};
use crate::fit::precision::{differences, no_answer};
use crate::scalar::{DoubleDouble, Real};
use crate::stiffness::Geometry;

/// The springs between nodes of the exact network of one element, in numbers of the kind of `any`, `[pairs]`, N/m. `mu`
/// is the shear modulus times the thickness; the nodes are at `x`, `[nodes × dimension]`, m.
///
/// # Errors
/// An array has a wrong length, a number is not finite, or the Jacobian is not positive everywhere.
pub fn exact_constants_of_kind<T: Real>(any: &T, element: &Element, x: &[f64], mu: f64) -> Result<Vec<T>> {
    check_nodes(element, element.dimension(), x)?;
    check_finite("mu", &[mu])?;
    let x = differences(any, element.dimension(), x);
    let mut geometry = Geometry::like(any, &element.tabulation);
    if !geometry.update(&element.tabulation, &x) {
        return Err(no_answer("the element has no stiffness"));
    }
    Ok(edges(&geometry, mu))
}

/// [`exact_constants_of_kind`] in double-double numbers, compiled in this package, which is optimised.
///
/// # Errors
/// Those of [`exact_constants_of_kind`].
pub fn exact_double_double_constants(element: &Element, x: &[f64], mu: f64) -> Result<Vec<DoubleDouble>> {
    exact_constants_of_kind(&DoubleDouble::from(0.0), element, x, mu)
}
