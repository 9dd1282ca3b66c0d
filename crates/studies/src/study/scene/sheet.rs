//! The mesh of a scene as a sheet or as rods that bend, if it does.

use super::document::Scene;
use crate::error::Result;
use crate::mesh::Mesh;

impl Scene {
    /// The mesh with the directors of a sheet or of rods, if the material bends as such.
    ///
    /// # Errors
    /// Those of the material, or the mesh is no surface of triangles or no lines; the key is that of the material.
    pub(super) fn bent(&self, mesh: Mesh) -> Result<Mesh> {
        let first = self.material.first();
        let bent = first.bending.of(mesh, [first.flexural, first.torsional], |mesh| self.material_of(mesh));
        bent.map_err(|e| e.placed(|e| self.at(&self.material.key(0), e)))
    }
}
