//! Whether a surface bends.

use crate::error::{Error, Result};
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use crate::range::positive;
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
    /// The mesh with what resists bending, if anything does; `material_of` has the thicknesses. If the flexural stiffness D, N·m, is given and not that of the
    /// thickness, `D/C_xx` of the stiffness C of the membrane has the place of `t²/12`, in the rotary inertia too.
    ///
    /// # Errors
    /// Those of the material; the mesh is no surface of triangles in space; or the flexural stiffness is not above zero, or belongs to no plate.
    pub fn of(
        self,
        mesh: Mesh,
        flexural: Option<f64>,
        material_of: impl Fn(&Mesh) -> Result<MaterialMap>,
    ) -> Result<Mesh> {
        if let Some(flexural) = flexural {
            positive("flexural", flexural, "N·m")?;
            if self == Bending::None {
                return Err(Error::expected("flexural", "bending = \"plate\" beside it", "none"));
            }
        }
        if self == Bending::None {
            return Ok(mesh);
        }
        let material = material_of(&mesh)?;
        let gyration = match flexural {
            None => material.thicknesses().map(|t| t * t / 12.0),
            Some(flexural) => material.moduli().map(|hooke| flexural / hooke.entries(2).0[0]),
        };
        let of_cells = mesh.cell_indices().map(|cell| *gyration.at(cell.block, cell.cell)).collect();
        mesh.with_directors(of_cells)
    }
}
