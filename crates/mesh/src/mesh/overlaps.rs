//! Cells that lie over others: on the same side of what they share, or in another piece of the mesh.

use super::embedding::cells_of_two_pieces;
use super::mesh::{CellIndex, Mesh, SideIndex};
use super::space::spatial;
use std::collections::HashSet;

/// Directions whose angle has a larger cosine are the same: 4e-5 rad, so that sheets that touch at a sharp edge are two.
const SAME: f64 = 1.0 - 1e-9;

/// The largest mesh whose pieces are compared: it takes about a second.
const MOST_CELLS: usize = 300_000;

impl Mesh {
    /// The number of cells that have points or middles of cells of another of these pieces inside them; 0 of surfaces and curves in space, and
    /// of larger meshes than [`MOST_CELLS`].
    pub(super) fn crossing(&self, pieces: &[Vec<usize>]) -> usize {
        if pieces.len() < 2 || self.cell_dimension() < self.dimension || self.cell_count() > MOST_CELLS {
            return 0;
        }
        let mut piece_of = vec![0; self.point_count()];
        for (piece, points) in pieces.iter().enumerate() {
            points.iter().for_each(|&p| piece_of[p] = piece);
        }
        cells_of_two_pieces(self, &piece_of).len()
    }

    /// Adds the cells of `sides`, which have the same points, that lie over another of them. In solids pairs are not tested: their cells are on
    /// both sides of what they share unless some are reversed, which is tested apart.
    pub(super) fn add_overlapping(&self, sides: &[SideIndex], found: &mut HashSet<CellIndex>) {
        if sides.len() < 2 || sides.len() < 3 && self.cell_dimension() > 2 {
            return;
        }
        let ways: Vec<Option<[f64; 3]>> = sides.iter().map(|side| self.way_from(side)).collect();
        for (i, one) in ways.iter().enumerate() {
            for (j, other) in ways.iter().enumerate().skip(i + 1) {
                if one.zip(*other).is_some_and(|(one, other)| product(one, other) > SAME) {
                    found.extend([sides[i].cell, sides[j].cell]);
                }
            }
        }
    }

    /// The direction from a side to the middle of its cell, orthogonal to the side.
    fn way_from(&self, side: &SideIndex) -> Option<[f64; 3]> {
        let at = |p: usize| spatial(self.point(p));
        let from = |x: [f64; 3], origin: [f64; 3]| [0, 1, 2].map(|k| x[k] - origin[k]);
        let points = self.side_nodes(side);
        let origin = at(points[0]);
        let mut tangents: Vec<[f64; 3]> = Vec::new();
        for _ in 1..self.cell_dimension() {
            let rests = points.iter().map(|&p| without(from(at(p), origin), &tangents));
            // The farthest point gives a tangent that is not of rounding.
            tangents.push(unit(rests.max_by(|a, b| product(*a, *a).total_cmp(&product(*b, *b)))?)?);
        }
        let nodes = self.cell_nodes(side.cell);
        let centre = [0, 1, 2].map(|k| nodes.iter().map(|&p| at(p)[k]).sum::<f64>() / nodes.len() as f64);
        unit(without(from(centre, origin), &tangents))
    }
}

fn product(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The part of a vector that is orthogonal to unit vectors.
fn without(mut v: [f64; 3], tangents: &[[f64; 3]]) -> [f64; 3] {
    for t in tangents {
        let along = product(v, *t);
        v = [0, 1, 2].map(|k| v[k] - along * t[k]);
    }
    v
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = product(v, v).sqrt();
    (length > 0.0).then(|| v.map(|x| x / length))
}
