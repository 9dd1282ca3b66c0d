//! Cells that share a side.

use crate::mesh::Mesh;
use crate::model::cell_places;
use std::collections::HashMap;

/// Two cells with a common side, and how much their difference counts: the size of the side over the distance of the middles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    /// The cells, counted through all blocks.
    pub cells: [usize; 2],
    /// The size of their side, as that of a cube with the content of the smaller cell.
    pub side: f64,
    /// The distance of their middles, m.
    pub distance: f64,
}

/// All pairs of neighbours.
pub(super) fn pairs(mesh: &Mesh) -> Vec<Pair> {
    let places: Vec<(f64, Vec<f64>)> = cell_places(mesh).concat();
    let mut sides: HashMap<Vec<usize>, usize> = HashMap::new();
    let (mut found, mut number) = (Vec::new(), 0);
    // The side of a cube of the content V is V^((d − 1)/d).
    let power = (mesh.cell_dimension() as f64 - 1.0) / mesh.cell_dimension().max(1) as f64;
    for block in &mesh.blocks {
        for nodes in block.cells() {
            for side in block.element.sides() {
                let mut key: Vec<usize> = side.nodes.iter().map(|&a| nodes[a]).collect();
                // Both cells of a side list its nodes, each in an order of its own.
                key.sort_unstable();
                // Two cells at most share a side: what was found needs to be known no more.
                if let Some(other) = sides.remove(&key) {
                    let ((a, x), (b, y)) = (&places[other], &places[number]);
                    let distance = x.iter().zip(y).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
                    found.push(Pair { cells: [other, number], side: a.min(*b).powf(power), distance });
                } else {
                    sides.insert(key, number);
                }
            }
            number += 1;
        }
    }
    found
}
