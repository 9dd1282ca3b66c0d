//! Where the content is measured.

/// The content that the springs for λ measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VolumeSprings {
    /// That of each quadrature point: the network is the finite element with this quadrature.
    #[default]
    Points,
    /// That of each cell: selective reduced integration, the mean dilatation of each cell (Nagtegaal, Parks, Rice 1974).
    Cells,
    /// That of a patch of cells around each node, whose springs a mesh adds.
    Patches,
}

crate::named!(VolumeSprings {
    "points" => Points,
    "cells" => Cells,
    "patches" => Patches,
});

/// Where content springs get their numbers from: of the first term a share of μ, of the second one of λ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    pub points: [f64; 2],
    pub cell: [f64; 2],
}

impl VolumeSprings {
    /// A cell with a single spring on its content has it for both terms, but where patches have that for λ.
    pub(super) fn shares(self, is_single: bool) -> Shares {
        match (self, is_single) {
            (VolumeSprings::Points, _) => Shares { points: [1.0, 1.0], cell: [1.0, 1.0] },
            (VolumeSprings::Cells, true) => Shares { points: [0.0, 0.0], cell: [1.0, 1.0] },
            (VolumeSprings::Cells, false) => Shares { points: [1.0, 0.0], cell: [0.0, 1.0] },
            (VolumeSprings::Patches, _) => Shares { points: [1.0, 0.0], cell: [1.0, 0.0] },
        }
    }
}
