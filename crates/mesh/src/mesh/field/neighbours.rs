//! The points that are nearest to a position.

use crate::mesh::space::{ends, hypot};
use std::collections::HashMap;

/// The number of points in a bin, on average over the box around the points.
// A bin and those around it have 54 points in space then, of which the nearest 14 that a plane is fitted to are found
// at once.
const CROWD: f64 = 2.0;

/// Points in bins.
pub(super) struct Neighbours {
    points: Vec<[f64; 3]>,
    low: [f64; 3],
    high: [f64; 3],
    /// The side of a bin, m.
    side: f64,
    bins: HashMap<[i64; 3], Vec<usize>>,
}

impl Neighbours {
    /// There is at least one point, and all coordinates are finite.
    pub fn new(points: Vec<[f64; 3]>) -> Neighbours {
        let [low, high] = ends(points.iter().copied());
        let extents: Vec<f64> = (0..3).map(|k| high[k] - low[k]).filter(|extent| *extent > 0.0).collect();
        let volume: f64 = extents.iter().product();
        let side = match extents.len() {
            // All points are at one place, for which bins of any width serve.
            0 => 1.0,
            d => (volume * CROWD / points.len() as f64).powf(1.0 / d as f64),
        };
        // A flat cloud would have more bins along it than points.
        let most = extents.iter().fold(0.0, |a: f64, b| a.max(*b)) / points.len() as f64;
        let side = side.max(most);
        let mut neighbours = Neighbours { points, low, high, side, bins: HashMap::new() };
        for point in 0..neighbours.points.len() {
            neighbours.bins.entry(neighbours.bin(&neighbours.points[point])).or_default().push(point);
        }
        neighbours
    }

    /// The position of a point, m.
    pub fn point(&self, point: usize) -> &[f64; 3] {
        &self.points[point]
    }

    /// The distance of a position from the box around the points, m.
    pub fn outside(&self, x: &[f64; 3]) -> f64 {
        (0..3).map(|k| (self.low[k] - x[k]).max(x[k] - self.high[k]).max(0.0)).fold(0.0, f64::hypot)
    }

    /// The largest extent of the box around the points, m.
    pub fn extent(&self) -> f64 {
        (0..3).map(|k| self.high[k] - self.low[k]).fold(0.0, f64::max)
    }

    /// The largest distance of a point from the nearest other one, or half the diagonal of the largest box between the coordinates that occur along
    /// each axis, whichever is larger, m: places between neighbours are not farther from them.
    pub fn spacing(&self) -> f64 {
        let nearest = |point: &[f64; 3]| self.nearest(point, 2).get(1).map_or(0.0, |(_, distance)| *distance);
        let gap = |k: usize| {
            let mut along: Vec<f64> = self.points.iter().map(|x| x[k]).collect();
            along.sort_unstable_by(f64::total_cmp);
            along.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
        };
        let half = 0.5 * (0..3).map(gap).fold(0.0, f64::hypot);
        self.points.iter().map(nearest).fold(half, f64::max)
    }

    /// The `count` points nearest to a position, or all if they are fewer, with their distances, m; the nearest first.
    pub fn nearest(&self, x: &[f64; 3], count: usize) -> Vec<(usize, f64)> {
        let count = count.min(self.points.len());
        // From the nearest place in the box, so that positions outside find bins at once.
        let inside: [f64; 3] = std::array::from_fn(|k| x[k].clamp(self.low[k], self.high[k]));
        let (middle, away) = (self.bin(&inside), hypot(&inside, x));
        let mut found: Vec<(usize, f64)> = Vec::new();
        for shell in 0.. {
            self.each_bin(middle, shell, |point| found.push((point, hypot(&self.points[point], x))));
            // Points of later shells are at least this far from the position.
            // Bins that were not visited are at least so far from the nearest place in the box, which is `away` from the position.
            let reach = shell as f64 * self.side - away;
            if found.len() == self.points.len() || found.iter().filter(|(_, d)| *d <= reach).count() >= count {
                break;
            }
        }
        // Equally near points are in the order of their numbers: means over neighbours are the same in each run.
        found.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        found.truncate(count);
        found
    }

    /// The points of the bins whose largest distance along an axis from this one is `shell`.
    fn each_bin(&self, middle: [i64; 3], shell: i64, mut visit: impl FnMut(usize)) {
        let mut of_bin = |bin: [i64; 3]| self.bins.get(&bin).into_iter().flatten().for_each(|point| visit(*point));
        for i in -shell..=shell {
            for j in -shell..=shell {
                let at = |k: i64| [middle[0] + i, middle[1] + j, middle[2] + k];
                if i.abs() == shell || j.abs() == shell {
                    (-shell..=shell).for_each(|k| of_bin(at(k)));
                } else {
                    of_bin(at(-shell));
                    of_bin(at(shell));
                }
            }
        }
    }

    fn bin(&self, x: &[f64; 3]) -> [i64; 3] {
        std::array::from_fn(|k| ((x[k] - self.low[k]) / self.side).floor() as i64)
    }
}
