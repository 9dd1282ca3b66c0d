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
    let roots: Vec<usize> = (0..cells.len()).map(|cell| parts.root(cell)).collect();
    let mut sizes: HashMap<usize, usize> = HashMap::new();
    roots.iter().for_each(|root| *sizes.entry(*root).or_default() += 1);
    // One part has no other to hang on.
    if sizes.len() == 1 {
        return vec![true; cells.len()];
    }
    let mut members: HashMap<usize, Vec<usize>> = HashMap::new();
    roots.iter().enumerate().for_each(|(cell, root)| members.entry(*root).or_default().push(cell));
    let mut order: Vec<Vec<usize>> = members.into_values().collect();
    // Larger parts first, and of equal ones that with the first cell: which part stays does not depend on the order of a hash map.
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
