//! The surface of a mesh as triangles, for programs that draw it or let it touch things.

use super::mesh::{CellBlock, Mesh, SideIndex};
use super::selection::Selection;

impl Mesh {
    /// The triangles between the corners of [`Mesh::surface_faces`], `[triangles]`. Faces with more than three corners are
    /// divided into a fan.
    pub fn surface_triangles(&self) -> Vec<[usize; 3]> {
        let mut triangles = Vec::new();
        self.surface_faces().iter().for_each(|corners| fan(corners, &mut triangles));
        triangles
    }

    /// The corners of the sides on the boundary of a solid, or of the cells of a plane or surface, `[faces][corners]`; none
    /// of a curve. The corners of a solid's face follow each other counterclockwise as seen from outside.
    pub fn surface_faces(&self) -> Vec<Vec<usize>> {
        match self.cell_dimension() {
            3 => {
                let sides = Selection::Everything.sides(self).expect("everything is no group that may be missing");
                let face = |SideIndex { cell, side }: &SideIndex| {
                    let nodes = self.cell_nodes(*cell);
                    let element = &self.blocks[cell.block].element;
                    let corners = element.cell.sides()[*side].corners.iter().filter_map(|&c| element.corner_node(c));
                    corners.map(|a| nodes[a]).collect()
                };
                sides.iter().map(face).collect()
            }
            2 => {
                let of_block = |block: &CellBlock| -> Vec<Vec<usize>> {
                    let count = block.element.cell.corners().len();
                    let corners: Vec<usize> = (0..count).filter_map(|c| block.element.corner_node(c)).collect();
                    block.cells().map(|nodes| corners.iter().map(|&a| nodes[a]).collect()).collect()
                };
                self.body_blocks().flat_map(|(_, block)| of_block(block)).collect()
            }
            _ => Vec::new(),
        }
    }
}

fn fan(corners: &[usize], triangles: &mut Vec<[usize; 3]>) {
    triangles.extend(
        corners.iter().skip(1).copied().collect::<Vec<_>>().windows(2).map(|pair| [corners[0], pair[0], pair[1]]),
    );
}
