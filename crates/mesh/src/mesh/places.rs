//! Points at the same position.

use super::coincident::first_near;
use super::mesh::Mesh;
use super::space::spatial;
use crate::springs::distance;

/// Positions of a mesh that its coordinates can distinguish.
pub(super) struct Places {
    /// For each point the first one at its position, `[points]`.
    pub first: Vec<usize>,
    /// The length of the shortest edge with a positive length, m.
    pub shortest_edge: f64,
    /// The rounding error of the coordinates, m.
    pub rounding: f64,
}

impl Places {
    /// Positions are equal within 1e-9 of the size of the body and a tenth of the shortest edge. `None` if the
    /// coordinates are too coarse to distinguish points.
    pub fn of(mesh: &Mesh) -> Option<Places> {
        let place = |p: usize| spatial(mesh.point(p));
        let points: Vec<[f64; 3]> = (0..mesh.point_count()).map(place).collect();
        let least: [f64; 3] = std::array::from_fn(|k| points.iter().map(|x| x[k]).fold(f64::INFINITY, f64::min));
        let extent = points.iter().flat_map(|x| (0..3).map(|k| x[k] - least[k])).fold(0.0, f64::max);
        // Coordinates far from the origin, which a program has moved or scaled some times, are known to so many
        // roundings.
        let rounding = 16.0 * f64::EPSILON * mesh.points.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
        let shortest_edge = shortest_edge(mesh, &points);
        // Points are one if they differ by rounding, and never if they are the ends of an edge.
        let unit = (1e-9 * extent).min(0.1 * shortest_edge).max(rounding);
        // Also refuses NaN.
        if !(unit > 0.0 && unit <= 0.1 * shortest_edge) {
            return None;
        }
        // The bins are so wide that few points are near the border of theirs, and so narrow that few points share one.
        let width = (1000.0 * unit).min(0.5 * shortest_edge);
        let first = first_near(&points, unit, width);
        Some(Places { first, shortest_edge, rounding })
    }

    /// The number of points at the position of another point.
    pub fn coincident(&self) -> usize {
        self.first.iter().enumerate().filter(|(p, first)| p != *first).count()
    }
}

/// Squares of lengths in these bounds have neither overflowed nor underflowed, m².
const ORDINARY: std::ops::Range<f64> = 1e-280..1e280;

/// The length of the shortest edge, m; infinite if no edge has a length.
fn shortest_edge(mesh: &Mesh, points: &[[f64; 3]]) -> f64 {
    // An edge is seen from each of its cells: squares are compared, and one root is taken.
    let (mut least_square, mut shortest) = (f64::INFINITY, f64::INFINITY);
    for block in &mesh.blocks {
        let corner = |c: usize| block.element.corner_node(c);
        let edges: Vec<[usize; 2]> =
            block.element.cell.edges().iter().filter_map(|[a, b]| Some([corner(*a)?, corner(*b)?])).collect();
        for nodes in block.cells() {
            for &[a, b] in &edges {
                let [a, b] = [&points[nodes[a]], &points[nodes[b]]];
                let square = (0..3).map(|k| (b[k] - a[k]) * (b[k] - a[k])).sum::<f64>();
                if ORDINARY.contains(&square) {
                    least_square = least_square.min(square);
                    continue;
                }
                // Nodes at one place have an edge without length, which says nothing of how near points may be.
                let length = distance(a, b);
                shortest = if length > 0.0 { shortest.min(length) } else { shortest };
            }
        }
    }
    shortest.min(least_square.sqrt())
}
