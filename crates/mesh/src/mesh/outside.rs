//! The boundary of a body as cells.

use super::mesh::{CellBlock, CellIndex, Mesh, SideIndex};
use super::selection::outer_sides;
use crate::element::Element;
use crate::error::Result;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

impl Mesh {
    /// The sides that belong to one cell alone, as cells of the shipped elements with their functions: one block for each element, on the points
    /// of this mesh, and for each of its cells the cell of the body behind it. The normals of their node orders point out of the body.
    ///
    /// # Errors
    /// No shipped element has the functions of a side (kind `Unsupported`).
    pub fn boundary_cells(&self) -> Result<Vec<(CellBlock, Vec<CellIndex>)>> {
        let mut known: HashMap<(usize, usize), (Arc<Element>, Vec<usize>)> = HashMap::new();
        let mut found: Vec<(CellBlock, Vec<CellIndex>)> = Vec::new();
        for side in outer_sides(self, &vec![true; self.point_count()]) {
            let kind = (side.cell.block, side.side);
            // To read elements takes longer than all else here.
            if let Entry::Vacant(place) = known.entry(kind) {
                place.insert(self.of_side(&side)?);
            }
            let (element, places) = &known[&kind];
            let place = found.iter().position(|(block, _)| block.element.name == element.name).unwrap_or_else(|| {
                let element = Arc::new(Element::clone(element).in_space(self.dimension));
                found.push((CellBlock { element, connectivity: Vec::new() }, Vec::new()));
                found.len() - 1
            });
            self.extend(&mut found[place], &side, places);
        }
        Ok(found)
    }

    fn extend(&self, (block, behind): &mut (CellBlock, Vec<CellIndex>), side: &SideIndex, places: &[usize]) {
        let nodes = self.cell_nodes(side.cell);
        block.connectivity.extend(places.iter().map(|&place| nodes[place]));
        behind.push(side.cell);
    }
}
