//! Cells that repeat another cell.

use super::mesh::{CellIndex, Mesh};
use crate::error::{Error, Result};
use std::collections::HashMap;

impl Mesh {
    /// Refuses or removes cells that have the same points as an earlier cell, in any order: they would double stiffness
    /// and mass.
    ///
    /// Points at the same position count as one point; `first` gives the first point at each position. The cell that is
    /// kept joins the groups of the removed cells.
    ///
    /// # Errors
    /// There are such cells, and `skip` is not set.
    pub(super) fn settle_duplicates(&mut self, first: Option<&[usize]>, skip: bool) -> Result<()> {
        let mut repeated: Vec<(CellIndex, CellIndex)> = Vec::new();
        self.each_cell_set(
            |p| first.map_or(p, |first| first[p]),
            |cells| {
                repeated.extend(cells[1..].iter().map(|cell| (*cell, cells[0])));
            },
        );
        if repeated.is_empty() {
            return Ok(());
        }
        // Sets of cells come in the order of their lowest points, and the message names the first cell of the mesh.
        repeated.sort_unstable_by_key(|(cell, _)| (cell.block, cell.cell));
        let cells: Vec<CellIndex> = repeated.iter().map(|(cell, _)| *cell).collect();
        if !skip {
            let (_, kept) = repeated[0];
            let (element, number) = (&self.blocks[kept.block].element.name, kept.cell + 1);
            let has = if cells.len() == 1 { "has" } else { "have" };
            let found = format!(
                "{} of {} that {has} the nodes of another, or nodes at the same places: {} (the first repeats {element} cell \
                 {number}); below = \"skip\" leaves them out",
                cells.len(),
                self.cell_count(),
                self.named(&cells)
            );
            return Err(Error::expected("cells", "each cell once", found));
        }
        // A group must not lose a place because its cell is the one that goes.
        let kept: HashMap<CellIndex, CellIndex> = repeated.into_iter().collect();
        for group in self.groups.values_mut() {
            group.cells.iter_mut().for_each(|cell| *cell = kept.get(cell).copied().unwrap_or(*cell));
            group.cells.sort_unstable_by_key(|cell| (cell.block, cell.cell));
            group.cells.dedup();
        }
        self.quality.duplicates = cells.len();
        self.remove(&cells).map(drop)
    }
}
