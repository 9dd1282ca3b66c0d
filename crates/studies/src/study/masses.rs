//! The masses of the points of a body.

use crate::error::{Error, ErrorKind, Result};
use crate::material::{CellMap, MaterialMap};
use crate::mesh::Mesh;
use crate::model::{Lumping, lumped_masses, masses};
use crate::range;

/// The row sums of the mass matrix for a `density` in kg/m³, of all cells or of each, `[points]`, kg.
///
/// # Errors
/// The density is out of range, a mass is not finite, or the body has no mass; the key is `density`.
pub fn point_masses(
    mesh: &Mesh,
    density: impl Into<CellMap<f64>>,
    material: impl Into<MaterialMap>,
) -> Result<Vec<f64>> {
    let density = density.into();
    density.values().try_for_each(|density| range::positive("density", *density, "kg/m³").map(|_| ()))?;
    let masses = masses(mesh, density, material.into().thicknesses());
    let total: f64 = masses.iter().sum();
    match masses.iter().all(|m| m.is_finite()) && total.is_normal() {
        true => Ok(masses),
        false => {
            let found = format!("{total:e} kg in all");
            Err(Error::expected("density", "one with which the body has a mass", found).of_kind(ErrorKind::Infeasible))
        }
    }
}

/// The row sums of the mass matrix or, if one of them is not positive, the masses of the HRZ method, `[points]`, kg.
pub fn inertial_masses(mesh: &Mesh, material: &MaterialMap, sums: Vec<f64>) -> Vec<f64> {
    match sums.iter().all(|m| *m > 0.0) {
        true => sums,
        false => lumped_masses(mesh, material.densities(), material.thicknesses(), Lumping::Hrz),
    }
}
