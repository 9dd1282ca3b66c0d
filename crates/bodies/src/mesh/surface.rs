//! The surface of a mesh as triangles, for programs that draw it or let it touch things.

use super::mesh::{Mesh, SideIndex};
use super::selection::Selection;

impl Mesh {
    /// The triangles between the corners of the sides on the boundary of a solid, or of the cells of a plane or surface,
    /// `[triangles]`; none of a curve. The corners of a solid's triangle follow each other counterclockwise as seen from
    /// outside. Sides with more than three corners are divided into a fan.
    pub fn surface_triangles(&self) -> Vec<[usize; 3]> {
        let mut triangles = Vec::new();
        match self.cell_dimension() {
            3 => {
                let sides = Selection::Everything.sides(self).expect("everything is no group that may be missing");
                for SideIndex { cell, side } in sides {
                    let nodes = self.cell_nodes(cell);
                    let element = &self.blocks[cell.block].element;
                    let corners = element.cell.sides()[side].corners.iter().filter_map(|&c| element.corner_node(c));
                    fan(&corners.map(|a| nodes[a]).collect::<Vec<_>>(), &mut triangles);
                }
            }
            2 => {
                for block in &self.blocks {
                    let count = block.element.cell.corners().len();
                    let corners: Vec<usize> = (0..count).filter_map(|c| block.element.corner_node(c)).collect();
                    for nodes in block.cells() {
                        fan(&corners.iter().map(|&a| nodes[a]).collect::<Vec<_>>(), &mut triangles);
                    }
                }
            }
            _ => {}
        }
        triangles
    }
}

fn fan(corners: &[usize], triangles: &mut Vec<[usize; 3]>) {
    triangles.extend(
        corners.iter().skip(1).copied().collect::<Vec<_>>().windows(2).map(|pair| [corners[0], pair[0], pair[1]]),
    );
}
