//! Checks of the quality of the cells of a mesh.

use super::mesh::{CellIndex, Mesh, SideIndex, sorted};
use super::quality::{Below, Gate, Worst};
use crate::error::{Error, Result};
use crate::stiffness::{Geometry, Placement};
use std::collections::HashSet;

/// The largest number of cells that a message names.
const NAMED: usize = 6;

impl Mesh {
    /// Measures every cell and treats the poor ones as the gate says.
    ///
    /// # Errors
    /// The gate refuses cells below its least quality, or no cell is left.
    pub(super) fn pass(&mut self, gate: Gate) -> Result<()> {
        let mut poor: Vec<CellIndex> = Vec::new();
        let mut worst: Option<(f64, CellIndex)> = None;
        self.each_quality(|cell, quality| {
            if worst.is_none_or(|(least, _)| quality < least) {
                worst = Some((quality, cell));
            }
            if quality < gate.least {
                poor.push(cell);
            }
        });
        let named = worst.map(|worst| self.named_worst(worst));
        if let (Some(worst), Below::Refuse, false) = (&named, gate.below, poor.is_empty()) {
            let found = format!("{} below it, the least {:.2e} of {}", cells(poor.len()), worst.quality, worst.cell);
            return Err(Error::expected("quality", format!("cells of at least {:e}", gate.least), found));
        }
        let folding = self.folding();
        if gate.below == Below::Refuse && !folding.is_empty() {
            let found =
                format!("{} that fold between quadrature points: {}", cells(folding.len()), self.named(&folding));
            return Err(Error::expected("quality", "cells whose Jacobian is positive everywhere", found));
        }
        if gate.below == Below::Skip {
            let known: HashSet<CellIndex> = poor.iter().copied().collect();
            poor.extend(folding.iter().filter(|cell| !known.contains(cell)));
        }
        if gate.below == Below::Skip && !poor.is_empty() {
            self.quality.skipped += poor.len();
            self.remove(&poor)?;
            // The cells that are left have the quality that they had, so that the second pass removes none and ends.
            return self.pass(gate);
        }
        self.quality.folding = (!folding.is_empty()).then(|| (folding.len(), self.named(&folding)));
        (self.quality.poor, self.quality.least) = (named.as_ref().map(|_| poor.len()), gate.least);
        (self.quality.worst, self.quality.worst_cell) = named.map(|worst| (worst.quality, worst.cell)).unzip();
        Ok(())
    }

    /// The worst of all cells, also of a mesh that no gate has seen, such as a box; `None` without cells.
    pub fn worst_cell(&self) -> Option<Worst> {
        let mut worst: Option<(f64, CellIndex)> = None;
        self.each_quality(|cell, quality| {
            if worst.is_none_or(|(least, _)| quality < least) {
                worst = Some((quality, cell));
            }
        });
        worst.map(|worst| self.named_worst(worst))
    }

    fn named_worst(&self, (quality, cell): (f64, CellIndex)) -> Worst {
        Worst { quality, cell: self.cell_name(cell) }
    }

    fn each_quality(&self, mut visit: impl FnMut(CellIndex, f64)) {
        for (block, cells) in self.blocks.iter().enumerate() {
            let table = &cells.element.tabulation;
            let mut placement = Placement::new(table);
            let mut x = vec![0.0; cells.element.nodes() * cells.element.dimension()];
            for (cell, nodes) in cells.cells().enumerate() {
                let quality =
                    placement.place(table, &self.points, nodes, &mut x).map_or(0.0, |()| Geometry::quality(table, &x));
                visit(CellIndex { block, cell }, quality);
            }
        }
    }

    pub(super) fn cell_name(&self, CellIndex { block, cell }: CellIndex) -> String {
        let element = &self.blocks[block].element;
        let first = self.blocks[block].connectivity[cell * element.nodes()];
        format!("{} cell {} at {:?} m", element.name, cell + 1, self.point(first))
    }

    /// The first few of some cells, in words.
    pub(super) fn named(&self, cells: &[CellIndex]) -> String {
        let names: Vec<String> = cells.iter().take(NAMED).map(|cell| self.cell_name(*cell)).collect();
        let rest = if cells.len() > NAMED { format!(" and {} more", cells.len() - NAMED) } else { String::new() };
        names.join(", ") + &rest
    }

    /// Removes cells, and the points that only they have. Returns the new indices of the cells of each block.
    ///
    /// # Errors
    /// No cell is left.
    pub(super) fn remove(&mut self, cells: &[CellIndex]) -> Result<Vec<Vec<usize>>> {
        let mut new: Vec<Vec<usize>> = self.blocks.iter().map(|block| vec![0; block.cells().len()]).collect();
        cells.iter().for_each(|at| new[at.block][at.cell] = usize::MAX);
        self.drop_sides_of(&new);
        for (block, new) in self.blocks.iter_mut().zip(&mut new) {
            let n = block.element.nodes();
            let mut kept = 0;
            for (cell, new) in new.iter_mut().enumerate().filter(|(_, new)| **new != usize::MAX) {
                block.connectivity.copy_within(cell * n..(cell + 1) * n, kept * n);
                *new = kept;
                kept += 1;
            }
            block.connectivity.truncate(kept * n);
        }
        if self.cell_count() == 0 {
            return Err(Error::expected("quality", "cells that may be kept", "none"));
        }
        for group in self.groups.values_mut() {
            group.cells.retain(|at| new[at.block][at.cell] != usize::MAX);
            group.cells.iter_mut().for_each(|at| at.cell = new[at.block][at.cell]);
        }
        let unused = self.unused_points;
        self.drop_unused_points();
        // Removed cells are not reported again.
        self.unused_points = unused;
        Ok(new)
    }

    /// Removes from groups the sides that removed cells alone have; `new` is `usize::MAX` for these.
    fn drop_sides_of(&mut self, new: &[Vec<usize>]) {
        if self.groups.values().all(|group| group.sides.is_empty()) {
            return;
        }
        let is_kept = |side: &SideIndex| new[side.cell.block][side.cell.cell] != usize::MAX;
        let points = |side: SideIndex| sorted(&self.side_nodes(&side));
        let mut lost: HashSet<Vec<usize>> = self.side_indices().filter(|side| !is_kept(side)).map(points).collect();
        self.side_indices().filter(is_kept).for_each(|side| {
            // A side between a removed cell and a kept one is still a side of the body.
            lost.remove(&points(side));
        });
        self.groups.values_mut().for_each(|group| group.sides.retain(|side| !lost.contains(side)));
    }
}

fn cells(count: usize) -> String {
    if count == 1 { "1 cell".into() } else { format!("{count} cells") }
}
