//! The numbers of functions beside those of the nodes, whose amplitudes are condensed cell by cell: bubbles and incompatible modes.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

/// The numbers by which kernels know the modes M_j of an element.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes<C = f64> {
    /// The gradients `∂M_j/∂ξ_k(ξ_q)`, `[points × modes × dimension]`.
    pub gradients: Vec<C>,
    /// Whether M_j vanishes on the sides of the cell, `[modes]`. The displacement of other modes jumps from cell to cell.
    pub bubbles: Vec<bool>,
    /// The gradients of the shape functions of the nodes at the centre of the cell, `[nodes × dimension]`.
    pub centre: Vec<C>,
}

impl<C> Modes<C> {
    /// The number of modes.
    pub fn count(&self) -> usize {
        self.bubbles.len()
    }

    /// Converts the numbers to another kind.
    pub(super) fn map<D>(&self, convert: impl Fn(&C) -> D) -> Modes<D> {
        let all = |values: &[C]| values.iter().map(&convert).collect();
        Modes { gradients: all(&self.gradients), bubbles: self.bubbles.clone(), centre: all(&self.centre) }
    }
}
