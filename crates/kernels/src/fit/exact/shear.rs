//! The choice of the domains over which the deformation is averaged.

/// Where the springs for μ measure the deformation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ShearSprings {
    /// In each cell, at its quadrature points.
    #[default]
    Cells,
    /// On the domain of each edge, an equal share of each cell at the edge, with the mean deformation gradient of these
    /// shares (Liu, Nguyen-Thoi, Lam 2009). A mesh has these springs.
    Edges,
}

crate::named!(ShearSprings {
    "cells" => Cells,
    "edges" => Edges,
});
