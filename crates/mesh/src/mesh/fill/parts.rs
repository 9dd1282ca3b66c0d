//! Parts of a lattice whose cells are joined by faces.

use crate::mesh::disjoint::DisjointSets;
use std::collections::HashMap;

/// Which cells to keep: of the parts that are joined by faces, those that share a corner with a larger kept part are left out,
/// because they would turn about it freely. `cells` are the corners of each cell, and `faces` their places in a cell.
pub(super) fn kept(cells: &[Vec<usize>], faces: &[&[usize]]) -> Vec<bool> {
    let mut parts = DisjointSets::new(cells.len());
    let mut first: HashMap<Vec<usize>, usize> = HashMap::new();
    for (index, corners) in cells.iter().enumerate() {
        for face in faces {
            let mut key: Vec<usize> = face.iter().map(|&a| corners[a]).collect();
            key.sort_unstable();
            // A face has two cells at most.
            if let Some(other) = first.remove(&key) {
                parts.join(index, other);
            } else {
                first.insert(key, index);
            }
        }
    }
    let mut order = parts.sets();
    // One part has no other to hang on.
    if order.len() == 1 {
        return vec![true; cells.len()];
    }
    // Larger parts first, and of equal ones that with the first cell.
    order.sort_by_key(|cells| (std::cmp::Reverse(cells.len()), cells[0]));
    let corners = cells.iter().flatten().max().map_or(0, |last| last + 1);
    let (mut taken, mut keep) = (vec![false; corners], vec![false; cells.len()]);
    for part in order {
        let is_apart = part.iter().flat_map(|&cell| &cells[cell]).all(|&corner| !taken[corner]);
        if is_apart {
            for &cell in &part {
                keep[cell] = true;
                cells[cell].iter().for_each(|&corner| taken[corner] = true);
            }
        }
    }
    keep
}
