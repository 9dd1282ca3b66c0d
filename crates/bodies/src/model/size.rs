//! Checks, before it is assembled, that the stiffness of a model fits into memory.

use super::network::Network;
use super::system::{body_entries, triangle};
use crate::error::Result;
use crate::memory;
use crate::mesh::Mesh;

/// Bytes for each entry of the lower triangle: 24 of its own and, while the equations are set up, for each of its two
/// positions 16 for the indices, 8 for their order, 8 to sort them and 8 for the value.
const BYTES: u64 = 24 + 2 * (16 + 8 + 8 + 8);
/// The advice if a model is too large.
pub const ADVICE: &str = "take a mesh with fewer points, or a machine with more memory";

fn check(what: &str, entries: usize) -> Result<()> {
    memory::require(what, entries as u64 * BYTES, ADVICE).map_err(|e| e.at_key("mesh"))
}

/// Checks that the stiffness of the finite elements and its equations fit into memory.
///
/// # Errors
/// They do not; the kind is `Limit`.
pub fn check_body(mesh: &Mesh) -> Result<()> {
    check("the stiffness of the finite elements", body_entries(mesh))
}

impl Network {
    /// The number of entries of [`stiffness`](Network::stiffness).
    pub fn entries(&self) -> usize {
        let d = self.dimension;
        let others: usize = self.on_same_points().map(|springs| triangle(springs[0].points.len() * d)).sum();
        self.lengths.len() * triangle(2 * d) + others
    }

    /// Checks that the stiffness and its equations fit into memory.
    ///
    /// # Errors
    /// They do not; the kind is `Limit`.
    pub fn check_size(&self) -> Result<()> {
        check("the stiffness of a network", self.entries())
    }
}
