//! The quantities that are compared from mesh to mesh: the work of the load, and the mean displacement of the loaded
//! part.

use crate::analysis::metrics::product;
use crate::error::Result;
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use crate::model::{Action, nodal_forces};
use crate::scalar::Sum;
use springfit_scenes::{LoadCase, Part, Scene, applied_cases};

/// A load on a mesh, which weights displacements.
pub struct Quantities {
    /// The nodal forces, `[points · dimension]`, N.
    forces: Vec<f64>,
    /// `∫ N_a dA` of the loaded part, or `∫ N_a dV`, or 1 for each of its points; `[points]`. None if displacements are
    /// prescribed.
    weights: Option<Vec<f64>>,
    dimension: usize,
}

impl Quantities {
    /// One for each load of the scene.
    ///
    /// # Errors
    /// Those of a run of the scene.
    pub fn of(scene: &Scene, mesh: &Mesh, material: &MaterialMap) -> Result<Vec<Quantities>> {
        let (_, cases) = applied_cases(scene, mesh, material)?;
        let weigh = |load: &LoadCase| -> Result<Option<Vec<f64>>> {
            let along_x: Vec<f64> = (0..mesh.dimension).map(|k| if k == 0 { 1.0 } else { 0.0 }).collect();
            let (unit, part) = match load.single() {
                Some((_, Action::Displacement(_) | Action::Volume(_) | Action::Moment(_))) => return Ok(None),
                // The cells of a surface in space carry the pressure themselves: their sides are edges, over which a
                // traction would be integrated.
                Some((part, Action::Pressure(_))) if mesh.cell_dimension() < mesh.dimension => {
                    (Action::body(&along_x), part)
                }
                Some((part, Action::Traction(_) | Action::Pressure(_))) => (Action::traction(&along_x), part),
                Some((part, Action::Force(_))) => (Action::Force(along_x), part),
                Some((part, Action::Body(_))) => (Action::body(&along_x), part),
                // Of several parts the mean is that of the body.
                None => (Action::body(&along_x), &Part::Everything),
            };
            let forces = nodal_forces(mesh, &part.selection(mesh.dimension)?, &unit, 1.0)?;
            Ok(Some(forces.chunks_exact(mesh.dimension).map(|f| f[0]).collect()))
        };
        let pairs = scene.loads().iter().zip(cases);
        let quantities = pairs.map(|(load, case)| {
            let weights = weigh(load)?;
            Ok(Quantities { forces: case.forces, weights, dimension: mesh.dimension })
        });
        quantities.collect()
    }

    /// Whether the load prescribes displacements; its work is then that of the forces that hold them.
    pub fn is_prescribed(&self) -> bool {
        self.weights.is_none()
    }

    /// The work `f·u` of the final nodal forces along the final displacements, J.
    pub fn work(&self, u: &[f64]) -> f64 {
        product(&self.forces, u)
    }

    /// The mean displacement `|∫ u dA|/A`, m; `None` if displacements are prescribed.
    pub fn mean_displacement(&self, u: &[f64]) -> Option<f64> {
        let weights = self.weights.as_ref()?;
        let total = weights.iter().copied().collect::<Sum>().value();
        let along = |k: usize| {
            let terms = weights.iter().zip(u.chunks_exact(self.dimension)).map(|(w, u)| w * u[k]);
            terms.collect::<Sum>().value() / total
        };
        Some((0..self.dimension).map(|k| along(k).powi(2)).sum::<f64>().sqrt())
    }
}
