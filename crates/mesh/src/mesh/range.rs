//! Ranges of the cells of a mesh, which are fitted apart from each other.

use super::mesh::{CellBlock, Mesh};
use std::ops::Range;

impl Mesh {
    /// The cells with these numbers, counted from 0 through all blocks, on all points and without groups.
    pub fn of_range(&self, cells: Range<usize>) -> Mesh {
        let mut mesh =
            Mesh { numbering: self.numbering.clone(), ..Mesh::of_points(self.dimension, self.points.clone()) };
        let mut first = 0;
        for block in &self.blocks {
            let (n, count) = (block.element.nodes(), block.cells().len());
            let own = |cell: usize| cell.clamp(first, first + count) - first;
            let (start, end) = (own(cells.start), own(cells.end));
            let connectivity = block.connectivity[start * n..end.max(start) * n].to_vec();
            mesh.blocks.push(CellBlock { element: block.element.clone(), connectivity });
            first += count;
        }
        mesh
    }

    /// Whether each point belongs to cells of this range alone, `[points]`.
    pub fn is_inside(&self, cells: Range<usize>) -> Vec<bool> {
        let mut is_inside = vec![true; self.point_count()];
        let all = self.blocks.iter().flat_map(CellBlock::cells).enumerate();
        for (_, nodes) in all.filter(|(cell, _)| !cells.contains(cell)) {
            nodes.iter().for_each(|&point| is_inside[point] = false);
        }
        is_inside
    }
}
