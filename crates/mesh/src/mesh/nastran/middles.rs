//! The middle nodes that element cards leave out.

use crate::mesh::annotations::Annotations;
use crate::mesh::listing::Listing;
use std::collections::HashMap;

/// The number that stands for a middle node that a card leaves out.
pub(super) const LACKING: u64 = 0;

/// Gives these cells the middle nodes that they lack: that of another cell on the same edge, or else a new one halfway between the ends of the edge,
/// which cells that lack it there share.
pub(super) fn complete(listing: &mut Listing, cells: &[usize], annotations: &mut Annotations) {
    if cells.is_empty() {
        return;
    }
    let places: HashMap<u64, usize> = listing.node_numbers.iter().enumerate().map(|(i, &n)| (n, i)).collect();
    let mut known: HashMap<[u64; 2], u64> = HashMap::new();
    for cell in 0..listing.cells.len() {
        let (edges, nodes) = (listing.cells.cell_type(cell).middles(), listing.cells.nodes(cell));
        for (place, ends) in edges.iter().enumerate() {
            let middle = nodes[nodes.len() - edges.len() + place];
            if middle != LACKING {
                known.insert(sorted(ends.map(|end| nodes[end])), middle);
            }
        }
    }
    let mut next = listing.node_numbers.iter().max().copied().unwrap_or(0).saturating_add(1);
    let [mut made, mut taken] = [0, 0];
    for &cell in cells {
        let edges = listing.cells.cell_type(cell).middles();
        let mut nodes = listing.cells.nodes(cell).to_vec();
        let first = nodes.len() - edges.len();
        for (place, ends) in edges.iter().enumerate() {
            if nodes[first + place] != LACKING {
                continue;
            }
            let ends = sorted(ends.map(|end| nodes[end]));
            if let Some(&middle) = known.get(&ends) {
                nodes[first + place] = middle;
                taken += 1;
                continue;
            }
            // An end may be missing in the file: the error comes later, when the nodes of the cell are looked up.
            let [Some(a), Some(b)] = ends.map(|end| places.get(&end).map(|&place| listing.points[place])) else {
                continue;
            };
            listing.node_numbers.push(next);
            listing.points.push(std::array::from_fn(|k| 0.5 * (a[k] + b[k])));
            known.insert(ends, next);
            nodes[first + place] = next;
            next = next.saturating_add(1);
            made += 1;
        }
        listing.cells.set_nodes(cell, &nodes);
    }
    let elements =
        if cells.len() == 1 { "1 element lacks".to_string() } else { format!("{} elements lack", cells.len()) };
    annotations.remark(format!(
        "{elements} some of the middle nodes: {made} were made halfway between the ends of their edges, and {taken} are those of other elements"
    ));
}

fn sorted([a, b]: [u64; 2]) -> [u64; 2] {
    if a < b { [a, b] } else { [b, a] }
}
