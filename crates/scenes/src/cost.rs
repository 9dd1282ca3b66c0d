//! What the loads of a scene take, by counts and rates that forecasts and the choice of a reference share.

use crate::mesh::{CellBlock, Mesh};

/// Solutions while one network is compared with the body: Lanczos' steps.
pub const COMPARISONS: f64 = 45.0;
/// Solutions of one load, with their refinement.
pub const REFINEMENTS: f64 = 3.0;

/// Entries of the stiffnesses of all cells.
pub fn entries(mesh: &Mesh) -> f64 {
    let of_block =
        |block: &CellBlock| block.cells().len() as f64 * ((block.element.nodes() * mesh.dimension) as f64).powi(2);
    mesh.blocks.iter().map(of_block).sum()
}
