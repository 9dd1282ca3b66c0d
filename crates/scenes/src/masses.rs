//! The masses of the points of a body.

use crate::error::{Error, ErrorKind, Result};
use crate::material::{CellMap, MaterialMap};
use crate::mesh::Mesh;
use crate::model::{Lumping, lumped_masses, masses};
use crate::range;

/// The masses of the points of a body.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PointMasses {
    /// `[points]`, kg.
    pub values: Vec<f64>,
    /// How they were lumped.
    pub lumping: Lumping,
}

/// The masses for a `density` in kg/m³, of all cells or of each: the row sums of the mass matrix or, where one of them is not
/// positive, which no motion allows, those of the HRZ method.
///
/// # Errors
/// The density is out of range, a mass is not finite, or the body has no mass; the key is `density`.
pub fn point_masses(
    mesh: &Mesh,
    density: impl Into<CellMap<f64>>,
    material: impl Into<MaterialMap>,
) -> Result<PointMasses> {
    let (density, thicknesses) = (density.into(), material.into().thicknesses());
    density.values().try_for_each(|density| range::positive("density", *density, "kg/m³").map(|_| ()))?;
    let sums = masses(mesh, density.clone(), thicknesses.clone());
    let total: f64 = sums.iter().sum();
    // A sum below the least normal number is as good as zero: frequencies would divide by it.
    if !(sums.iter().all(|m| m.is_finite()) && total.is_normal()) {
        let found = format!("{total:e} kg in all");
        let error = Error::expected("density", "one with which the body has a mass", found);
        return Err(error.of_kind(ErrorKind::Infeasible));
    }
    Ok(match sums.iter().all(|m| *m > 0.0) {
        true => PointMasses { values: sums, lumping: Lumping::RowSum },
        false => {
            let values = lumped_masses(mesh, density, thicknesses, Lumping::Hrz);
            PointMasses { values, lumping: Lumping::Hrz }
        }
    })
}
