//! The choice of the domains over which the deformation is averaged.

use super::volume::VolumeSprings;
use crate::error::{Error, ErrorKind, Result};

/// Where the springs for μ measure the deformation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ShearSprings {
    /// In each cell, at its quadrature points.
    #[default]
    Cells,
    /// On the domain of each edge, an equal share of each cell at the edge, with the mean deformation gradient of these
    /// shares (Liu, Nguyen-Thoi, Lam 2009). They belong to edges and not to cells: `edge_springs` of a mesh makes them.
    Edges,
}

impl ShearSprings {
    /// Whether all springs belong to single cells, with these springs for λ.
    pub fn is_of_cells(self, volume: VolumeSprings) -> bool {
        self == ShearSprings::Cells && volume != VolumeSprings::Patches
    }

    /// Checks that these springs for λ go with them.
    ///
    /// # Errors
    /// λ has springs on cells and μ on edges; the kind is `Unsupported`.
    pub fn check(self, volume: VolumeSprings) -> Result<()> {
        if self == ShearSprings::Edges && volume == VolumeSprings::Cells {
            let expected = "\"points\" or \"patches\" with shear = \"edges\": springs on cells lock";
            return Err(Error::expected("volume", expected, "\"cells\"").of_kind(ErrorKind::Unsupported));
        }
        Ok(())
    }
}

crate::named!(ShearSprings {
    "cells" => Cells,
    "edges" => Edges,
});
