//! Points at the same place as one point: at exactly the same coordinates, or near each other.

use crate::springs::distance;
use std::collections::HashMap;

/// Points at exactly the same coordinates as one point.
#[derive(Default)]
pub(super) struct Coincident {
    pub points: Vec<[f64; 3]>,
    known: HashMap<[u64; 3], usize>,
}

impl Coincident {
    /// The index of the point at these coordinates, which is added if there is none.
    pub fn index(&mut self, point: [f64; 3]) -> usize {
        // −0 and 0 are the same coordinate.
        let point = point.map(|x| x + 0.0);
        *self.known.entry(point.map(f64::to_bits)).or_insert_with(|| {
            self.points.push(point);
            self.points.len() - 1
        })
    }
}

/// For each point the first one that is not farther from it than `unit`, or that such a point has been given, `[points]`.
///
/// Bins have edges of `width`, which is larger than `unit`: so wide that few points are near the border of theirs, and so narrow that few
/// points share one.
pub(super) fn first_near(points: &[[f64; 3]], unit: f64, width: f64) -> Vec<usize> {
    let least: [f64; 3] = std::array::from_fn(|k| points.iter().map(|x| x[k]).fold(f64::INFINITY, f64::min));
    let bin = |x: &[f64; 3], k: usize, shift: f64| ((x[k] - least[k] + shift) / width).floor() as i64;
    let mut bins: HashMap<[i64; 3], usize> = HashMap::with_capacity(points.len());
    // The previous point in the same bin.
    let mut before = vec![usize::MAX; points.len()];
    let mut first: Vec<usize> = (0..points.len()).collect();
    for (p, x) in points.iter().enumerate() {
        let mut found = usize::MAX;
        let range = |k: usize| bin(x, k, -unit)..=bin(x, k, unit);
        for i in range(0) {
            for j in range(1) {
                for k in range(2) {
                    // A list in two arrays needs no memory for each bin.
                    let mut other = bins.get(&[i, j, k]).copied().unwrap_or(usize::MAX);
                    while other != usize::MAX {
                        if distance(&points[other], x) <= unit {
                            // The least number wins, so that the result does not depend on the order of bins.
                            found = found.min(first[other]);
                        }
                        other = before[other];
                    }
                }
            }
        }
        if found != usize::MAX {
            first[p] = found;
        }
        let own = bins.entry([bin(x, 0, 0.0), bin(x, 1, 0.0), bin(x, 2, 0.0)]).or_insert(usize::MAX);
        before[p] = std::mem::replace(own, p);
    }
    first
}
