//! Whether the cells of a mesh are good enough, and whether its points fit together.

use super::mesh::{CellIndex, Mesh};
use super::quality::{Below, Gate, Worst};
use crate::error::{Error, Result};
use crate::springs::distance;
use crate::stiffness::{Geometry, Placement};
use std::collections::{HashMap, HashSet};

impl Mesh {
    /// Measures every cell and does with the poor ones what the gate says.
    ///
    /// # Errors
    /// The gate refuses cells that are below its least quality, or no cell is left.
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
        let named = worst.map(|(quality, cell)| Worst { quality, cell: self.cell_name(cell) });
        if let (Some(worst), Below::Refuse, false) = (&named, gate.below, poor.is_empty()) {
            let found = format!("{} below it, the least {:.2e} of {}", cells(poor.len()), worst.quality, worst.cell);
            return Err(Error::expected("quality", format!("cells of at least {:e}", gate.least), found));
        }
        if gate.below == Below::Skip && !poor.is_empty() {
            self.quality.skipped += poor.len();
            self.remove(&poor)?;
            return self.pass(gate);
        }
        self.quality.worst = named;
        (self.quality.poor, self.quality.least) = (poor.len(), gate.least);
        Ok(())
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

    /// Takes cells out, and the points that only they have.
    ///
    /// # Errors
    /// No cell is left.
    pub(super) fn remove(&mut self, cells: &[CellIndex]) -> Result<()> {
        let mut new: Vec<Vec<usize>> = self.blocks.iter().map(|block| vec![0; block.cells().len()]).collect();
        cells.iter().for_each(|at| new[at.block][at.cell] = usize::MAX);
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
        // Those of the cells that are gone are not told again.
        self.unused_points = unused;
        Ok(())
    }

    /// Counts points at the place of another, and points in the middle of a straight edge between two others. Places count as one
    /// within 1e-9 of the body and a tenth of the shortest edge; where coordinates do not tell so much, nothing is counted.
    pub(super) fn find_misfits(&mut self) {
        let mut edges: Vec<[usize; 2]> = Vec::new();
        // Nodes that are no corners: middles of edges that have them.
        let mut between = vec![false; self.point_count()];
        for block in &self.blocks {
            let element = &block.element;
            let corner = |c: usize| element.corner_node(c);
            let own: Vec<[usize; 2]> =
                element.cell.edges().iter().filter_map(|[a, b]| Some([corner(*a)?, corner(*b)?])).collect();
            let corners: Vec<usize> = (0..element.cell.corners().len()).filter_map(corner).collect();
            for nodes in block.cells() {
                edges.extend(own.iter().map(|[a, b]| [nodes[*a].min(nodes[*b]), nodes[*a].max(nodes[*b])]));
                (0..nodes.len()).filter(|a| !corners.contains(a)).for_each(|a| between[nodes[a]] = true);
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let d = self.dimension;
        let length = |[a, b]: &[usize; 2]| distance(self.point(*a), self.point(*b));
        let shortest = edges.iter().map(length).filter(|l| *l > 0.0).fold(f64::INFINITY, f64::min);
        let place =
            |p: usize| -> [f64; 3] { std::array::from_fn(|k| if k < d { self.points[p * d + k] } else { 0.0 }) };
        let all = || (0..self.point_count()).map(place);
        let least: [f64; 3] = std::array::from_fn(|k| all().map(|x| x[k]).fold(f64::INFINITY, f64::min));
        let extent = all().flat_map(|x| (0..3).map(move |k| x[k] - least[k])).fold(0.0, f64::max);
        let rounding = 16.0 * f64::EPSILON * self.points.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
        let unit = (1e-9 * extent).min(0.1 * shortest).max(rounding);
        if unit > 0.1 * shortest {
            return;
        }
        let key = |x: [f64; 3]| -> [i64; 3] { std::array::from_fn(|k| ((x[k] - least[k]) / unit).floor() as i64) };
        let mut places: HashMap<[i64; 3], usize> = HashMap::new();
        let near = |places: &HashMap<[i64; 3], usize>, x: [f64; 3]| {
            let at = key(x);
            let beside = (0..27).map(|i| [at[0] + i % 3 - 1, at[1] + i / 3 % 3 - 1, at[2] + i / 9 - 1]);
            let mut found = beside.filter_map(|key| places.get(&key).copied());
            found.find(|p| distance(&place(*p), &x) <= unit)
        };
        let mut coincident = 0;
        for p in 0..self.point_count() {
            coincident += usize::from(near(&places, place(p)).is_some());
            places.entry(key(place(p))).or_insert(p);
        }
        let middle = |[a, b]: [usize; 2]| -> [f64; 3] {
            let (a, b) = (place(a), place(b));
            std::array::from_fn(|k| a[k] + (b[k] - a[k]) / 2.0)
        };
        let at_middle = |edge: &[usize; 2]| near(&places, middle(*edge)).filter(|p| !edge.contains(p) && !between[*p]);
        let hanging = edges.iter().filter_map(at_middle).collect::<HashSet<usize>>().len();
        (self.quality.coincident, self.quality.hanging) = (coincident, hanging);
    }
}

fn cells(count: usize) -> String {
    if count == 1 { "1 cell".into() } else { format!("{count} cells") }
}
