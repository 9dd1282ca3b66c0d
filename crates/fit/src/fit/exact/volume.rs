//! The choice of the contents that springs measure.

/// The content that the springs for λ measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VolumeSprings {
    /// The content of each quadrature point: the network is equal to the finite element with this quadrature.
    #[default]
    Points,
    /// The content of each cell: selective reduced integration with the mean dilatation of each cell (Nagtegaal, Parks,
    /// Rice 1974).
    Cells,
    /// The content of a patch of cells around each node. They belong to nodes and not to cells: `patch_springs` of a mesh makes them.
    Patches,
}

crate::named!(VolumeSprings {
    "points" => Points,
    "cells" => Cells,
    "patches" => Patches,
});

/// Which springs on content receive the two terms: the first number is a share of μ, the second a share of λ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    pub points: [f64; 2],
    pub cell: [f64; 2],
}

impl VolumeSprings {
    /// A cell with a single spring on its content gives both terms to it, unless patches receive λ.
    pub(super) fn shares(self, is_single: bool) -> Shares {
        match (self, is_single) {
            (VolumeSprings::Points, _) => Shares { points: [1.0, 1.0], cell: [1.0, 1.0] },
            (VolumeSprings::Cells, true) => Shares { points: [0.0, 0.0], cell: [1.0, 1.0] },
            (VolumeSprings::Cells, false) => Shares { points: [1.0, 0.0], cell: [0.0, 1.0] },
            (VolumeSprings::Patches, _) => Shares { points: [1.0, 0.0], cell: [1.0, 0.0] },
        }
    }
}
