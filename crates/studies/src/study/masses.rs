//! The masses of the points of a body.

use crate::error::{Error, ErrorKind, Result};
use crate::material::Material;
use crate::mesh::Mesh;
use crate::model::masses;
use crate::range;

/// The row sums of the mass matrix for a `density` in kg/m³, `[points]`, kg.
///
/// # Errors
/// The density is out of range, a mass is not finite, or the body has no mass; the key is `density`.
pub fn point_masses(mesh: &Mesh, density: f64, material: Material) -> Result<Vec<f64>> {
    range::positive("density", density, "kg/m³")?;
    let masses = masses(mesh, density, material.thickness());
    let total: f64 = masses.iter().sum();
    match masses.iter().all(|m| m.is_finite()) && total.is_normal() {
        true => Ok(masses),
        false => {
            let found = format!("{total:e} kg in all");
            Err(Error::expected("density", "one with which the body has a mass", found).of_kind(ErrorKind::Infeasible))
        }
    }
}
