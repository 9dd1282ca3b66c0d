//! The connected parts of a mesh: those that share no node with each other.

use super::disjoint::DisjointSets;
use super::mesh::Mesh;

impl Mesh {
    /// The points of each connected part, ascending; the parts are in the order of their first points. Two cells are
    /// connected if they share a node: different nodes at one position do not connect cells.
    pub fn pieces(&self) -> Vec<Vec<usize>> {
        // A director goes with its edge.
        let first = self.node_count();
        let edges = self.directors.iter().flat_map(|directors| &directors.edges).enumerate();
        let of_directors: Vec<[usize; 2]> = edges.map(|(e, [a, _])| [first + e, *a]).collect();
        let cells = self.blocks.iter().flat_map(|block| block.cells());
        pieces_of(
            self.point_count(),
            cells.chain(of_directors.iter().map(<[usize; 2]>::as_slice)).map(|nodes| nodes.iter().copied()),
        )
    }
}

/// The points that groups of points, such as cells or springs, connect with each other, each piece ascending.
pub fn pieces_of(points: usize, groups: impl Iterator<Item = impl Iterator<Item = usize>>) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(points);
    for mut nodes in groups {
        let Some(first) = nodes.next() else { continue };
        nodes.for_each(|node| sets.join(node, first));
    }
    sets.sets()
}
