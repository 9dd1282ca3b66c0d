//! The connected parts of a mesh: those that share no node with each other.

use super::mesh::Mesh;

impl Mesh {
    /// The points of each connected part, ascending; the parts are in the order of their first points. Two cells are
    /// connected if they share a node: different nodes at one position do not connect cells.
    pub fn pieces(&self) -> Vec<Vec<usize>> {
        let mut parent: Vec<usize> = (0..self.point_count()).collect();
        for nodes in self.blocks.iter().flat_map(|block| block.cells()) {
            let first = root(&mut parent, nodes[0]);
            for &node in &nodes[1..] {
                let other = root(&mut parent, node);
                parent[other] = first;
            }
        }
        let mut piece_of_root = vec![usize::MAX; parent.len()];
        let mut pieces: Vec<Vec<usize>> = Vec::new();
        for point in 0..parent.len() {
            let piece = &mut piece_of_root[root(&mut parent, point)];
            if *piece == usize::MAX {
                *piece = pieces.len();
                pieces.push(Vec::new());
            }
            pieces[*piece].push(point);
        }
        pieces
    }
}

/// The point that represents the part of `point`; paths to it are halved on the way.
fn root(parent: &mut [usize], mut point: usize) -> usize {
    while parent[point] != point {
        parent[point] = parent[parent[point]];
        point = parent[point];
    }
    point
}
