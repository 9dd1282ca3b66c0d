//! The connected parts of a mesh: those that share no node with each other.

use super::disjoint::DisjointSets;
use super::mesh::Mesh;

impl Mesh {
    /// The points of each connected part, ascending; the parts are in the order of their first points. Two cells are
    /// connected if they share a node: different nodes at one position do not connect cells.
    pub fn pieces(&self) -> Vec<Vec<usize>> {
        let mut sets = DisjointSets::new(self.point_count());
        for nodes in self.blocks.iter().flat_map(|block| block.cells()) {
            nodes[1..].iter().for_each(|&node| sets.join(node, nodes[0]));
        }
        if let Some(directors) = &self.directors {
            let first = self.node_count();
            directors.edges.iter().enumerate().for_each(|(e, [a, _])| sets.join(first + e, *a));
        }
        let mut piece_of_root = vec![usize::MAX; self.point_count()];
        let mut pieces: Vec<Vec<usize>> = Vec::new();
        for point in 0..self.point_count() {
            let piece = &mut piece_of_root[sets.root(point)];
            if *piece == usize::MAX {
                *piece = pieces.len();
                pieces.push(Vec::new());
            }
            pieces[*piece].push(point);
        }
        pieces
    }
}
