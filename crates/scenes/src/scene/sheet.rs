//! The mesh of a scene as a sheet or as rods that bend, if it does.

use super::bending::RestShape;
use super::document::Scene;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::solve::StaticMethod;

impl Scene {
    /// The mesh with the directors of a sheet or of rods, if the material bends as such.
    ///
    /// # Errors
    /// Those of the material, or the mesh is no surface of triangles or no lines; the key is that of the material. Equations of directors are asked to be solved on levels.
    pub(super) fn bent(&self, mesh: Mesh) -> Result<Mesh> {
        let first = self.material.first();
        let bent = first.bending.of(mesh, [first.flexural, first.torsional], |mesh| self.material_of(mesh));
        let mut bent = bent.map_err(|e| e.placed(|e| self.at(&self.material.key(0), e)))?;
        if let Some(directors) = &mut bent.directors {
            directors.flat = first.rest == RestShape::Flat;
        }
        if bent.directors.is_some() && self.solver().method == StaticMethod::Multigrid {
            let expected = "\"cholesky\" or \"auto\" for a sheet or rods that bend, whose directors have no levels";
            return Err(self.at("solver", Error::expected("method", expected, "\"multigrid\"")));
        }
        Ok(bent)
    }
}
