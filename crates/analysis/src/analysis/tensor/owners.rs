//! To what the springs of a network belong.

use crate::fit::{CellFits, ExactFit};

/// To what the springs of a network belong, from which those of a sample follow.
#[derive(Clone, Copy)]
pub enum SpringOwners<'a> {
    /// To cells: the springs of each block.
    Cells(&'a [CellFits]),
    /// To the domains of edges. A sample has the springs of the domains that its own cells make.
    Edges(ExactFit),
    /// To the body as a whole, as those of whole-object fits: each spring is shared equally among the cells that have all
    /// of its points.
    Body,
}
