//! Whether a surface bends.

use crate::error::Result;
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use schemars::JsonSchema;
use serde::Deserialize;

/// How a surface in space resists bending.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Bending {
    /// It does not: the surface is a membrane.
    #[default]
    None,
    /// It does as a thin plate of this thickness, with the flexural stiffness `D = E t³/(12 (1 − ν²))`.
    Plate,
}

impl Bending {
    /// The mesh with what resists bending, if anything does; `material_of` has the thicknesses.
    ///
    /// # Errors
    /// Those of the material; or the mesh is no surface of triangles in space.
    pub fn of(self, mesh: Mesh, material_of: impl Fn(&Mesh) -> Result<MaterialMap>) -> Result<Mesh> {
        match self {
            Bending::None => Ok(mesh),
            Bending::Plate => {
                let gyration = material_of(&mesh)?.thicknesses().map(|t| t * t / 12.0);
                let of_cells = mesh.cell_indices().map(|cell| *gyration.at(cell.block, cell.cell)).collect();
                mesh.with_directors(of_cells)
            }
        }
    }
}
