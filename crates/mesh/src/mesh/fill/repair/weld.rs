//! Corners of open edges that are at one place but for rounding.

use crate::mesh::coincident::first_near;
use crate::mesh::fill::edges::open;
use crate::mesh::fill::triangles::Triangles;
use crate::springs::distance;

/// How far corners are apart that are one, relative to the diagonal of the box around the surface: first as far as coordinates in single
/// precision or with seven digits are rounded, then, where edges are still open, as far as texts with five digits are, and no farther than
/// scanners resolve.
const TOLERANCES: [f64; 3] = [1e-6, 1e-5, 1e-4];
/// The share of the median length of the open edges by which corners are moved at most, so that small triangles stay.
const OF_EDGE: f64 = 0.1;

/// What was welded.
#[derive(Default)]
pub(in crate::mesh::fill) struct Welded {
    /// Corners that were put together with another.
    pub corners: usize,
    /// The largest distance between two of them, m.
    pub distance: f64,
    /// Triangles that had the corners of another, before or after, and were left out.
    pub doubles: usize,
}

/// Makes corners of open edges one that are near each other. Corners between triangles that are joined stay, however near they are, so
/// that a thin wall is not closed.
pub(in crate::mesh::fill) fn weld(triangles: &mut Triangles) -> Welded {
    // Two triangles that are one would close each other's edges.
    let mut welded = Welded { doubles: doubles(triangles), ..Welded::default() };
    let extent = triangles.extent();
    for tolerance in TOLERANCES {
        let edges = open(&triangles.corners);
        if edges.is_empty() {
            break;
        }
        let mut lengths: Vec<f64> =
            edges.iter().map(|[a, b]| distance(&triangles.points[*a], &triangles.points[*b])).collect();
        lengths.sort_unstable_by(f64::total_cmp);
        // A unit beyond a share of the median edge would weld corners of one triangle.
        let unit = (tolerance * extent).min(OF_EDGE * lengths[lengths.len() / 2]);
        let mut ends: Vec<usize> = edges.into_iter().flatten().collect();
        // An end belongs to two open edges or more.
        ends.sort_unstable();
        ends.dedup();
        let places: Vec<[f64; 3]> = ends.iter().map(|&p| triangles.points[p]).collect();
        // A bin has few points of a surface of a million triangles.
        let first = first_near(&places, unit, (10.0 * unit).max(1e-3 * extent));
        let mut other: Vec<usize> = (0..triangles.points.len()).collect();
        for (end, first) in first.into_iter().enumerate().filter(|(end, first)| end != first) {
            other[ends[end]] = ends[first];
            welded.corners += 1;
            welded.distance = welded.distance.max(distance(&places[end], &places[first]));
        }
        let faces = std::mem::take(&mut triangles.faces);
        for (corners, face) in std::mem::take(&mut triangles.corners).into_iter().zip(faces) {
            triangles.add(corners.map(|p| other[p]), face);
        }
        welded.doubles += doubles(triangles);
    }
    welded
}

/// Leaves out triangles between the points of an earlier one, however they are turned; returns how many there were.
fn doubles(triangles: &mut Triangles) -> usize {
    let mut order: Vec<([usize; 3], usize)> =
        triangles.corners.iter().enumerate().map(|(t, c)| (sorted(*c), t)).collect();
    order.sort_unstable();
    let mut is_double = vec![false; order.len()];
    for pair in order.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        is_double[pair[1].1] = true;
    }
    triangles.retain(|t| !is_double[t]);
    order.len() - triangles.corners.len()
}

fn sorted(mut corners: [usize; 3]) -> [usize; 3] {
    corners.sort_unstable();
    corners
}
