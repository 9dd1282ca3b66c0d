//! What the changes of an effective stiffness depend on.

use super::lanes::Block;

/// What the changes of a product `K_N y` depend on.
#[derive(Debug)]
pub(super) struct History {
    /// What the sweeps begin with.
    pub start: Block,
    /// What each sweep has found, by springs or by points.
    pub sweeps: Vec<Block>,
    /// The number of degrees of freedom.
    pub size: usize,
}
