//! The order of cells in their source, in which those of different groups may take turns.

use super::mesh::{CellIndex, Mesh};
use super::source::SourceBlock;
use std::ops::Range;

/// Where the cells of a mesh come from, block after block.
#[derive(Default)]
pub(super) struct SourceOrder {
    /// The turns of the runs, and the cells that each has become.
    runs: Vec<Vec<(usize, Range<usize>)>>,
    /// The cells of some source have no known order.
    is_unknown: bool,
}

impl SourceOrder {
    /// Adds the cells of a source, which are those of a block of the mesh from `first` on.
    pub fn add(&mut self, block: usize, first: usize, source: &SourceBlock) {
        self.runs.resize_with(self.runs.len().max(block + 1), Vec::new);
        self.is_unknown |= source.runs.is_empty();
        let starts = source.runs.iter().map(|run| run.start).chain([source.connectivity.len()]);
        let cells: Vec<usize> = starts.map(|start| first + start / source.nodes_per_cell).collect();
        let ranges = cells.windows(2).map(|ends| ends[0]..ends[1]);
        self.runs[block].extend(source.runs.iter().map(|run| run.turn).zip(ranges));
    }

    /// Puts the cells of each block into the order of their source, so that values of cells from elsewhere are those of the same cells here.
    pub fn restore(mut self, mesh: &mut Mesh) {
        if self.is_unknown {
            return;
        }
        for (index, runs) in self.runs.iter_mut().enumerate().filter(|(_, runs)| !runs.is_sorted_by_key(|run| run.0)) {
            runs.sort_unstable_by_key(|(turn, _)| *turn);
            let block = &mut mesh.blocks[index];
            let nodes = block.element.nodes();
            let mut connectivity = Vec::with_capacity(block.connectivity.len());
            let mut places = vec![0; block.connectivity.len() / nodes];
            for cell in runs.iter().flat_map(|(_, cells)| cells.clone()) {
                places[cell] = connectivity.len() / nodes;
                connectivity.extend_from_slice(&block.connectivity[cell * nodes..(cell + 1) * nodes]);
            }
            block.connectivity = connectivity;
            for group in mesh.groups.values_mut() {
                let of_block = |at: &CellIndex| at.block == index;
                group.cells.iter_mut().filter(|at| of_block(at)).for_each(|at| at.cell = places[at.cell]);
                group.cells.sort_unstable_by_key(|at| (at.block, at.cell));
            }
        }
    }
}
