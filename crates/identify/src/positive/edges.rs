//! The springs between two points that a network may have.

use crate::error::{Error, ErrorKind, Result};
use crate::mesh::Mesh;
use crate::model::LengthSpring;
use crate::springs::distance;
use crate::stiffness::each_cell;

/// The share of the volume of two cells that counts for a spring across their common side. It is small, so that such
/// springs are a last resort.
// A tetrahedron counts for each of its six edges by 1/6, four times as much.
const ACROSS: f64 = 1.0 / 24.0;

/// Pairs of points, sorted, each with the data that the programme requires.
#[derive(Debug, Clone, Default)]
pub(super) struct Edges {
    pub pairs: Vec<[usize; 2]>,
    /// The constants of the exact network, N/m.
    pub constants: Vec<f64>,
    /// The lengths at rest, m.
    pub lengths: Vec<f64>,
    /// The share of the contents of the cells around the edge, mᵈ.
    pub volumes: Vec<f64>,
    /// Whether the pair belongs to no cell.
    pub across: Vec<bool>,
}

impl Edges {
    /// All pairs of points of one cell, with the constants of `springs`, which must be sorted by their points; with
    /// `is_across` also the pairs of points opposite a common side of two simplices.
    ///
    /// # Errors
    /// Points coincide; a spring joins other points or is out of order; or springs across sides are requested and the
    /// cells are not linear simplices in a space of their own dimension (kind `Unsupported`).
    pub fn new(mesh: &Mesh, springs: &[LengthSpring], is_across: bool) -> Result<Edges> {
        let mut shares: Vec<([usize; 2], bool, f64)> = Vec::new();
        let mut sides: Vec<(Vec<usize>, usize, f64)> = Vec::new();
        for block in &mesh.blocks {
            let table = &block.element.tabulation;
            let n = table.nodes;
            if is_across && (n != mesh.dimension + 1 || table.dimension != mesh.dimension) {
                let expected = "a mesh of simplices of corners in their own space, triangles or tetrahedra";
                return Err(Error::expected("across", expected, &block.element.name).of_kind(ErrorKind::Unsupported));
            }
            let pairs = (n * (n - 1) / 2) as f64;
            let visit = |cell: usize, _: &[f64], geometry: &crate::stiffness::Geometry| {
                let nodes = block.cell(cell);
                let volume = geometry.content().abs();
                for a in 0..n {
                    // A cell whose corners coincide names a node twice.
                    let others = (a + 1..n).filter(|b| nodes[*b] != nodes[a]);
                    shares.extend(others.map(|b| (ordered(nodes[a], nodes[b]), false, volume / pairs)));
                    if is_across {
                        let mut side: Vec<usize> = (0..n).filter(|b| *b != a).map(|b| nodes[b]).collect();
                        // Sorted, so that the two cells at a side name it alike.
                        side.sort_unstable();
                        sides.push((side, nodes[a], volume));
                    }
                }
            };
            each_cell(table, &mesh.points, &block.connectivity, visit).expect("a mesh holds only cells with a volume");
        }
        // Equal sides come together, each with the point opposite to it; a side belongs to two cells at most.
        sides.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.cmp(&b.1)));
        for pair in sides.windows(2).filter(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1) {
            shares.push((ordered(pair[0].1, pair[1].1), true, ACROSS * (pair[0].2 + pair[1].2)));
        }
        // False comes before true, so that a pair that a cell has as well counts as one of the cell.
        shares.sort_unstable_by_key(|(pair, across, _)| (*pair, *across));
        let mut edges = Edges::default();
        let mut springs = springs.iter().peekable();
        for (pair, across, volume) in shares {
            if edges.pairs.last() == Some(&pair) {
                // The first share of a pair tells whether it belongs to a cell.
                if !across {
                    *edges.volumes.last_mut().expect("there is a pair") += volume;
                }
                continue;
            }
            let constant = springs.next_if(|s| s.points == pair).map_or(0.0, |s| s.constant);
            edges.pairs.push(pair);
            edges.constants.push(constant);
            edges.lengths.push(distance(mesh.point(pair[0]), mesh.point(pair[1])));
            edges.volumes.push(volume);
            edges.across.push(across);
        }
        if let Some(edge) = edges.lengths.iter().position(|length| !(*length > 0.0)) {
            let [i, j] = edges.pairs[edge];
            let found = format!("{} and {} in one", mesh.point_title(i), mesh.point_title(j));
            return Err(Error::expected("mesh", "points apart", found));
        }
        if let Some(spring) = springs.next() {
            let [i, j] = spring.points;
            let expected = "springs between two points of a cell, sorted by their points";
            let found = format!("one between {} and {}", mesh.point_title(i), mesh.point_title(j));
            return Err(Error::expected("network", expected, found));
        }
        Ok(edges)
    }

    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// `X_j − X_i` of a pair.
    pub fn vector(&self, mesh: &Mesh, edge: usize) -> Vec<f64> {
        let [i, j] = self.pairs[edge];
        mesh.point(i).iter().zip(mesh.point(j)).map(|(a, b)| b - a).collect()
    }
}

fn ordered(a: usize, b: usize) -> [usize; 2] {
    [a.min(b), a.max(b)]
}
