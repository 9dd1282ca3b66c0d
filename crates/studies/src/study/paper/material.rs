//! The material of single elements.

use crate::error::Result;
use crate::material::Material;

/// The material of an element of this dimension, in plane stress in the plane; `young` in Pa.
///
/// # Errors
/// A constant is out of range.
pub fn material(dimension: usize, young: f64, poisson: f64) -> Result<Material> {
    Material::for_body(dimension, young, poisson, None, None)
}
