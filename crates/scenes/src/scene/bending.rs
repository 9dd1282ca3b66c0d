//! Whether a surface or a line bends.

use crate::error::{Error, Result};
use crate::material::{CellMap, Hooke, MaterialMap};
use crate::mesh::Mesh;
use crate::range::positive;
use schemars::JsonSchema;
use serde::Deserialize;
use std::f64::consts::PI;

/// How a surface or a line in space resists bending.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Bending {
    /// It does not: a surface is a membrane, and lines are bars with joints that turn.
    #[default]
    None,
    /// A surface does as a thin plate of this thickness, with the flexural stiffness `D = E t³/(12 (1 − ν²))`.
    Plate,
    /// Lines do as slender rods of a round cross-section A, with the flexural stiffness `E I` of `I = A²/(4 π)` and the torsional stiffness `E I/(1 + ν)`. Rods
    /// that share a point are joined rigidly there.
    Rod,
}

/// Where a sheet that bends is at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RestShape {
    /// As the mesh is.
    #[default]
    Mesh,
    /// Where it is flat: each edge of two triangles pulls them into one plane. The mesh has its lengths.
    Flat,
}

impl Bending {
    /// The mesh with what resists bending, if anything does; `material_of` has thicknesses and cross-sections, and the flexural and the torsional stiffness are those that are given. If the flexural stiffness D, N·m, of a sheet is given and
    /// not that of the thickness, `D/C_xx` of the stiffness C of the membrane has the place of `t²/12`, in the rotary inertia too; as `E I/(E A)` has that
    /// of `I/A` of a rod.
    ///
    /// # Errors
    /// Those of the material; the mesh is no surface of triangles or no bars in space; or a stiffness is not above zero, or belongs to nothing that bends.
    pub fn of(
        self,
        mesh: Mesh,
        [flexural, torsional]: [Option<f64>; 2],
        material_of: impl Fn(&Mesh) -> Result<MaterialMap>,
    ) -> Result<Mesh> {
        let given = [
            ("flexural", flexural, self != Bending::None, "bending = \"plate\" or \"rod\" beside it"),
            ("torsional", torsional, self == Bending::Rod, "bending = \"rod\" beside it"),
        ];
        for (key, value, belongs, expected) in given {
            let Some(value) = value else { continue };
            positive(key, value, if self == Bending::Rod { "N·m²" } else { "N·m" })?;
            if !belongs {
                let found = if self == Bending::None { "none" } else { "\"plate\"" };
                return Err(Error::expected(key, expected, found));
            }
        }
        if self == Bending::None {
            return Ok(mesh);
        }
        let material = material_of(&mesh)?;
        let of_cells = |values: &CellMap<f64>| -> Vec<f64> {
            mesh.cell_indices().map(|cell| *values.at(cell.block, cell.cell)).collect()
        };
        let over_stretch = |stiffness: f64| {
            let entries = |hooke: &Hooke| hooke.entries(mesh.cell_dimension()).0[0];
            material.moduli().map(|hooke| stiffness / entries(hooke))
        };
        let contents = material.thicknesses();
        if self == Bending::Plate {
            // I/A of a rectangle is t²/12. A stiffness in N·m that is given is divided by the stretching stiffness of
            // the cell, which is that share too.
            let gyration = of_cells(&flexural.map_or_else(|| contents.map(|t| t * t / 12.0), over_stretch));
            return mesh.with_directors(gyration);
        }
        if mesh.cell_dimension() != 1 || mesh.dimension != 3 {
            let found = format!("cells of {} dimensions in {}", mesh.cell_dimension(), mesh.dimension);
            return Err(Error::expected("bending", "lines in space, which bend as a \"rod\"", found));
        }
        // A round section has I = π r⁴/4 and A = π r², so that I/A = r²/4 = A/(4 π).
        let gyration = of_cells(&flexural.map_or_else(|| contents.map(|area| area / (4.0 * PI)), over_stretch));
        let torsion = match torsional {
            Some(torsional) => of_cells(&over_stretch(torsional)),
            None => {
                let poisson = of_cells(&material.materials()?.map(|material| material.poisson()));
                // A round section has J = 2 I, and G = E/(2 (1 + ν)): G J/(E A) is I/A over 1 + ν.
                gyration.iter().zip(poisson).map(|(gyration, poisson)| gyration / (1.0 + poisson)).collect()
            }
        };
        mesh.with_joints(gyration, torsion)
    }
}
