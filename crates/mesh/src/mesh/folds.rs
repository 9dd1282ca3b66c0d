//! Cells that are folded over their neighbours, or within themselves.

use super::mesh::{CellBlock, CellIndex, Mesh, SideIndex};
use crate::element::JacobianBounds;
use crate::springs::{distance, dot};
use crate::stiffness::gather;
use rayon::prelude::*;
use std::collections::HashMap;

/// Heights below this share of the lengths count as zero. A centre in the plane of the shared side is on neither side
/// of it.
const FLAT: f64 = 1e-9;

impl Mesh {
    /// The cells that lie on the same side of a shared side as their neighbour. In each connected body these are the
    /// smaller of the two sets within which all neighbours lie on opposite sides of what they share.
    ///
    /// A cell may be numbered in the opposite order and lie correctly; then it is not among them.
    pub(super) fn folded(&self) -> Vec<CellIndex> {
        // The neighbours of each cell, and whether the two overlap.
        let mut beside: HashMap<CellIndex, Vec<(CellIndex, bool)>> = HashMap::new();
        let mut any = false;
        self.each_side_set(|sides| {
            for side in &sides[1..] {
                let overlap = self.overlap(&sides[0], side);
                any |= overlap;
                beside.entry(sides[0].cell).or_default().push((side.cell, overlap));
                beside.entry(side.cell).or_default().push((sides[0].cell, overlap));
            }
        });
        // Nearly all meshes end here, without a walk over the cells.
        if !any {
            return Vec::new();
        }
        let mut folded = Vec::new();
        let mut part: HashMap<CellIndex, bool> = HashMap::new();
        for start in self.cell_indices() {
            if part.contains_key(&start) {
                continue;
            }
            // A side with cells on both sides of it connects cells of the same set, any other side cells of different
            // sets.
            let mut parts: [Vec<CellIndex>; 2] = Default::default();
            part.insert(start, false);
            let mut next = vec![start];
            while let Some(cell) = next.pop() {
                let own = part[&cell];
                parts[usize::from(own)].push(cell);
                for (other, overlap) in beside.get(&cell).into_iter().flatten() {
                    part.entry(*other).or_insert_with(|| {
                        next.push(*other);
                        own != *overlap
                    });
                }
            }
            let [one, other] = parts;
            // Which of two sets is folded over the other cannot be told: the smaller one is most likely the fault.
            folded.extend(if one.len() < other.len() { one } else { other });
        }
        folded.sort_unstable_by_key(|cell| (cell.block, cell.cell));
        folded
    }

    /// The curved cells whose Jacobian determinant is negative somewhere between their quadrature points. Cells whose nodes are
    /// their corners or lie straight between them are not looked at.
    pub fn folding(&self) -> Vec<CellIndex> {
        let of_block = |(index, block): (usize, &CellBlock)| {
            let Some(bounds) =
                JacobianBounds::of(&block.element).filter(|_| block.element.dimension() == self.dimension)
            else {
                return Vec::new();
            };
            let n = block.element.nodes();
            let folds = |(cell, nodes): (usize, &[usize])| {
                let mut x = vec![0.0; n * self.dimension];
                gather(&self.points, self.dimension, nodes, &mut x);
                bounds.folds(&x).then_some(CellIndex { block: index, cell })
            };
            // Cells are independent of each other, and are collected in their order.
            block.connectivity.par_chunks_exact(n).enumerate().filter_map(folds).collect()
        };
        self.blocks.iter().enumerate().flat_map(of_block).collect()
    }

    /// Whether the cells of two sides with the same points lie on the same side of it.
    fn overlap(&self, one: &SideIndex, other: &SideIndex) -> bool {
        let nodes = self.side_nodes(one);
        let origin = self.point(nodes[0]);
        let from = |x: &[f64]| -> Vec<f64> { x.iter().zip(origin).map(|(x, o)| x - o).collect() };
        // The farthest node, and below the largest product: of others little but rounding may be left.
        let along = nodes.iter().map(|&p| from(self.point(p)));
        let Some(along) = along.max_by(|a, b| dot(a, a).total_cmp(&dot(b, b))) else { return false };
        let normal = match self.dimension {
            2 => vec![-along[1], along[0]],
            _ => {
                let cross = |b: Vec<f64>| {
                    let a = &along;
                    vec![a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
                };
                let normals = nodes.iter().map(|&p| cross(from(self.point(p))));
                let Some(normal) = normals.max_by(|a, b| dot(a, a).total_cmp(&dot(b, b))) else { return false };
                normal
            }
        };
        let height = |cell: CellIndex| {
            let nodes = self.cell_nodes(cell);
            let mean = |k: usize| nodes.iter().map(|&p| self.point(p)[k]).sum::<f64>() / nodes.len() as f64;
            let centre: Vec<f64> = (0..self.dimension).map(mean).collect();
            let height = dot(&normal, &from(&centre));
            let size = dot(&normal, &normal).sqrt() * distance(&centre, origin);
            if height.abs() <= FLAT * size { 0.0 } else { height.signum() }
        };
        // The sign of the normal, which is not known, cancels in the product.
        height(one.cell) * height(other.cell) > 0.0
    }
}
