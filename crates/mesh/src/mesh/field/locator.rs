//! Finds points of a mesh by their positions.

use crate::mesh::mesh::Mesh;
use crate::mesh::space::{hypot, spatial};

/// The largest distance of a position from its point, relative to the largest extent of the mesh. It covers positions
/// that are written with seven digits.
const TOLERANCE: f64 = 1e-6;

/// Points sorted by the bin in which they lie; a bin is a few times wider than the tolerance.
pub(super) struct Locator {
    points: Vec<[f64; 3]>,
    corner: [f64; 3],
    /// The tolerance, m.
    tolerance: f64,
    bins: Vec<([i64; 3], usize)>,
}

impl Locator {
    pub fn new(mesh: &Mesh) -> Locator {
        let points: Vec<[f64; 3]> = (0..mesh.point_count()).map(|p| spatial(mesh.point(p))).collect();
        let ends = |k: usize| points.iter().fold((f64::MAX, f64::MIN), |(lo, hi), x| (lo.min(x[k]), hi.max(x[k])));
        let corner = std::array::from_fn(|k| ends(k).0);
        let extent = (0..3).map(|k| ends(k).1 - ends(k).0).fold(0.0, f64::max);
        let mut locator = Locator { points, corner, tolerance: TOLERANCE * extent, bins: Vec::new() };
        locator.bins = locator.points.iter().enumerate().map(|(p, x)| (locator.bin(x, 0.0), p)).collect();
        // A bin is found by halving.
        locator.bins.sort_unstable();
        locator
    }

    /// The nearest point within the tolerance; several if they are equally near, such as points at one position.
    pub fn at(&self, position: &[f64]) -> Vec<usize> {
        let x = spatial(position);
        let (low, high) = (self.bin(&x, -self.tolerance), self.bin(&x, self.tolerance));
        let mut nearest = self.tolerance;
        let mut found = Vec::new();
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                for k in low[2]..=high[2] {
                    let start = self.bins.partition_point(|(bin, _)| *bin < [i, j, k]);
                    for &(_, point) in self.bins[start..].iter().take_while(|(bin, _)| *bin == [i, j, k]) {
                        let away = hypot(&self.points[point], &x);
                        // A nearer point replaces all that were equally near before.
                        if away < nearest {
                            found.clear();
                        }
                        if away <= nearest {
                            nearest = away;
                            found.push(point);
                        }
                    }
                }
            }
        }
        found
    }

    /// The nearest of all points, and its distance, m.
    pub fn nearest(&self, position: &[f64]) -> (usize, f64) {
        let x = spatial(position);
        let distances = self.points.iter().map(|point| hypot(point, &x));
        distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::INFINITY))
    }

    /// The distance of the point from a position, and whether it is within the tolerance.
    pub fn distance(&self, point: usize, position: &[f64]) -> (f64, bool) {
        let away = hypot(&self.points[point], &spatial(position));
        (away, away <= self.tolerance)
    }

    fn bin(&self, x: &[f64; 3], shift: f64) -> [i64; 3] {
        // The cast stays in the range of i64, and turns NaN into 0.
        std::array::from_fn(|k| ((x[k] - self.corner[k] + shift) / (4.0 * self.tolerance)).floor() as i64)
    }
}
