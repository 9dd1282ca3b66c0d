//! The edges, diagonals and opposite sides of a cell, found from its geometry.

use super::quantity::Quantity;
use crate::element::{Cell, Element};
use crate::error::{Error, ErrorKind, Result};

/// How two corners of a cell are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joint {
    /// Along an edge of the cell.
    Edge,
    /// Across a side of a solid cell.
    FaceDiagonal,
    /// Through the inside of the cell.
    Diagonal,
}

/// The corners of a cell, as nodes of an element without other nodes.
#[derive(Debug)]
pub struct Corners {
    /// Every pair of nodes, and how it is joined.
    pub joints: Vec<([usize; 2], Joint)>,
    /// For each pair of opposite sides of a quadrilateral or hexahedron their nodes, first those of the one, then those
    /// of the other.
    pub facing: Vec<Vec<usize>>,
}

impl Corners {
    /// The corners of this element.
    ///
    /// # Errors
    /// The nodes of the element are not exactly the corners of the cell.
    pub fn of(element: &Element) -> Result<Corners> {
        let cell = element.cell;
        let corners = cell.corners();
        let nodes: Option<Vec<usize>> = (0..corners.len()).map(|corner| element.corner_node(corner)).collect();
        let Some(nodes) = nodes.filter(|_| element.nodes() == corners.len()) else {
            let expected = format!("{} nodes at the corners of the cell", corners.len());
            let error = Error::expected(&element.name, expected, format!("{} nodes", element.nodes()));
            return Err(error.of_kind(ErrorKind::Unsupported));
        };
        let edges = edges(cell);
        let together = |pair: &[usize; 2]| cell.sides().iter().any(|s| pair.iter().all(|i| s.corners.contains(i)));
        let joint = |pair: [usize; 2]| match edges.contains(&pair) {
            true => Joint::Edge,
            false if together(&pair) => Joint::FaceDiagonal,
            false => Joint::Diagonal,
        };
        let pairs = (0..corners.len()).flat_map(|i| (i + 1..corners.len()).map(move |j| [i, j]));
        let joints = pairs.map(|pair| (pair.map(|i| nodes[i]), joint(pair))).collect();
        let mut facing = Vec::new();
        for (i, side) in cell.sides().iter().enumerate().filter(|_| cell.is_box()) {
            for other in &cell.sides()[..i] {
                if !side.corners.iter().any(|corner| other.corners.contains(corner)) {
                    facing.push(other.corners.iter().chain(side.corners).map(|&corner| nodes[corner]).collect());
                }
            }
        }
        Ok(Corners { joints, facing })
    }

    /// How two nodes are joined.
    pub fn joint(&self, [a, b]: [usize; 2]) -> Option<Joint> {
        self.joints.iter().find(|(pair, _)| *pair == [a, b] || *pair == [b, a]).map(|(_, joint)| *joint)
    }

    /// The pairs that are joined in this way.
    pub fn joined(&self, by: Joint) -> impl Iterator<Item = [usize; 2]> {
        self.joints.iter().filter(move |(_, joint)| *joint == by).map(|(pair, _)| *pair)
    }

    /// The index of the pair of opposite sides between which an edge runs.
    pub fn direction(&self, edge: [usize; 2]) -> Option<usize> {
        let first = |nodes: &[usize], a: usize| nodes[..nodes.len() / 2].contains(&a);
        self.facing.iter().position(|nodes| first(nodes, edge[0]) != first(nodes, edge[1]))
    }

    /// The mean length of the edges in each direction of a quadrilateral or hexahedron, m.
    pub fn extents<T: Quantity>(&self, length: impl Fn([usize; 2]) -> T) -> Vec<T> {
        let mean = |direction: usize| {
            let along = self.joined(Joint::Edge).filter(|&edge| self.direction(edge) == Some(direction));
            let lengths: Vec<T> = along.map(&length).collect();
            let count = lengths.len() as f64;
            Some(lengths.into_iter().reduce(|sum, length| sum + length)? / count)
        };
        (0..self.facing.len()).filter_map(mean).collect()
    }
}

/// The edges of a cell by its corners, the lower one first.
fn edges(cell: Cell) -> Vec<[usize; 2]> {
    let mut edges: Vec<[usize; 2]> = match cell.dimension() {
        1 => vec![[0, 1]],
        2 => cell.sides().iter().map(|side| [side.corners[0], side.corners[1]]).collect(),
        _ => {
            let of_side = |side: &crate::element::Side| {
                let own = side.cell.sides().iter();
                own.map(|edge| [0, 1].map(|end| side.corners[edge.corners[end]])).collect::<Vec<_>>()
            };
            cell.sides().iter().flat_map(of_side).collect()
        }
    };
    // Two sides share an edge, which each of them passes in its own direction.
    edges.iter_mut().for_each(|edge| edge.sort_unstable());
    edges.sort_unstable();
    edges.dedup();
    edges
}
