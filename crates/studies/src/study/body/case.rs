//! A load on a mesh.

use crate::mesh::Field;
use crate::model::Support;
use crate::study::metrics::{DisplacementError, displacement_error};
use crate::study::outcome::Measured;

/// A load on this mesh: what is held, and the nodal forces.
pub struct Case {
    pub name: String,
    pub support: Support,
    pub forces: Vec<f64>,
    /// Displacements that were measured under it, `[points · dimension]`, m, where known.
    pub measured: Option<Field>,
}

impl Case {
    /// How far displacements are from those measured under the load, at the points that were measured, or else from those of the
    /// finite elements.
    pub fn error(&self, fem: &[f64], found: &[f64], dimension: usize) -> Option<DisplacementError> {
        let Some(field) = &self.measured else { return displacement_error(fem, found, dimension) };
        let (mut wanted, mut own) = (Vec::new(), Vec::new());
        for (measured, u) in field.displacements.chunks_exact(dimension).zip(found.chunks_exact(dimension)) {
            if measured.iter().any(Option::is_some) {
                wanted.extend(measured.iter().map(|m| m.unwrap_or(0.0)));
                own.extend(measured.iter().zip(u).map(|(m, u)| m.map_or(0.0, |_| *u)));
            }
        }
        displacement_error(&wanted, &own, dimension)
    }

    /// The number of measured points, and how far the finite elements, with displacements `fem`, are from them.
    pub fn measured(&self, fem: &[f64], dimension: usize) -> Option<Measured> {
        let known = |point: &&[Option<f64>]| point.iter().any(Option::is_some);
        let points = self.measured.as_ref()?.displacements.chunks_exact(dimension).filter(known).count();
        Some(Measured { points, error: self.error(fem, fem, dimension) })
    }
}
