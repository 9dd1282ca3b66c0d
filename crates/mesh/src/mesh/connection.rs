//! The connected parts of a mesh: those that share no node with each other.

use super::disjoint::DisjointSets;
use super::mesh::Mesh;

impl Mesh {
    /// The points of each connected part, ascending; the parts are in the order of their first points. Two cells are
    /// connected if they share a node: different nodes at one position do not connect cells.
    pub fn pieces(&self) -> Vec<Vec<usize>> {
        pieces_of(self.point_count(), self.blocks.iter().flat_map(|block| block.cells()))
    }
}

/// The points that groups of points, such as cells or springs, connect with each other, each piece ascending.
pub fn pieces_of<'a>(points: usize, groups: impl Iterator<Item = &'a [usize]>) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(points);
    for nodes in groups {
        nodes[1..].iter().for_each(|&node| sets.join(node, nodes[0]));
    }
    let mut piece_of_root = vec![usize::MAX; points];
    let mut pieces: Vec<Vec<usize>> = Vec::new();
    for point in 0..points {
        let piece = &mut piece_of_root[sets.root(point)];
        if *piece == usize::MAX {
            *piece = pieces.len();
            pieces.push(Vec::new());
        }
        pieces[*piece].push(point);
    }
    pieces
}
