//! The mesh of a scene as a sheet that bends, if it does.

use super::document::Scene;
use crate::error::Result;
use crate::mesh::Mesh;

impl Scene {
    /// The mesh with the directors of a sheet, if the material bends as one.
    ///
    /// # Errors
    /// Those of the material, or the mesh is no surface of triangles; the key is that of the material.
    pub(super) fn bent(&self, mesh: Mesh) -> Result<Mesh> {
        let first = self.material.first();
        let bent = first.bending.of(mesh, first.flexural, |mesh| self.material_of(mesh));
        bent.map_err(|e| e.placed(|e| self.at(&self.material.key(0), e)))
    }
}
