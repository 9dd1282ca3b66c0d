//! Integrals over the cells of a mesh, by rules of a degree that fits the integrand.

use crate::element::{Element, Integrand};
use crate::mesh::{CellIndex, Mesh};
use crate::springs::Content;
use crate::stiffness::gather;

/// The quadrature points in one cell.
pub(super) struct CellPoints<'a> {
    pub index: CellIndex,
    /// The nodes of the cell, `[nodes]`, as points of the mesh.
    pub nodes: &'a [usize],
    /// The values `N_a(ξ_q)`, `[points × nodes]`.
    values: &'a [f64],
    /// The contents `w_q |J_q|`, `[points]`, m³ (m² on a surface, m on a curve).
    contents: &'a [f64],
}

impl CellPoints<'_> {
    /// `N_a(ξ_q)`, `[nodes]`, and `w_q |J_q|` at each point.
    pub fn each(&self) -> impl Iterator<Item = (&[f64], f64)> {
        self.values.chunks_exact(self.nodes.len()).zip(self.contents.iter().copied())
    }
}

/// Calls `visit` for every cell of the mesh that `chosen` selects, with a rule for the integrand.
///
/// A cell whose Jacobian is positive at the points of its stiffness may have a negative one elsewhere; such points
/// count as negative.
pub(super) fn each_cell_points(
    mesh: &Mesh,
    integrand: Integrand,
    chosen: impl Fn(CellIndex) -> bool,
    mut visit: impl FnMut(&CellPoints),
) {
    let d = mesh.dimension;
    for (index, block) in mesh.blocks.iter().enumerate() {
        let element: &Element = &block.element;
        let table = element.integration_table(integrand);
        let mut x = vec![0.0; table.nodes * d];
        for (cell, nodes) in block.cells().enumerate() {
            let index = CellIndex { block: index, cell };
            if !chosen(index) {
                continue;
            }
            gather(&mesh.points, d, nodes, &mut x);
            // Differences keep the digits of a cell that is far from the origin.
            let first = x[..d].to_vec();
            x.chunks_exact_mut(d).for_each(|x| x.iter_mut().zip(&first).for_each(|(x, o)| *x -= o));
            let contents: Vec<f64> = (0..table.points()).map(|q| Content::of_point(&table, q, &x).value()).collect();
            visit(&CellPoints { index, nodes, values: &table.values, contents: &contents });
        }
    }
}
