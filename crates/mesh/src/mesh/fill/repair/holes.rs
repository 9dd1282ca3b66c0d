//! Holes of a surface: the loops at which it ends, and triangles that close them.
//!
//! What a surface of any triangles ends at is a sum of loops, because the border of a border is nothing. With each loop closed, the surface
//! winds around each place a whole number of times: as often as the open surface does by its solid angle, rounded (A. Jacobson, L. Kavan, O. Sorkine-Hornung,
//! *Robust inside-outside segmentation using generalized winding numbers*, ACM Transactions on Graphics 32 (2013)), but near the holes.

use crate::mesh::fill::edges::{Pass, by_edge, counts};
use crate::mesh::fill::triangles::Triangles;
use crate::springs::distance;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// A loop at which a surface ends, and what closes it.
pub(super) struct Hole {
    /// The points of the loop, in the direction in which the surface passes them.
    pub points: Vec<usize>,
    /// The triangles that close it.
    pub cap: Vec<[usize; 3]>,
    /// The area of those, m².
    pub area: f64,
}

/// The holes of the surface with these passes.
pub(super) fn holes(triangles: &Triangles, passes: &[Pass]) -> Vec<Hole> {
    // The ends to which edges lead that are passed more often that way than back.
    let mut next: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for of_edge in by_edge(passes) {
        let ([a, b], [up, down]) = (of_edge[0].edge, counts(of_edge));
        let (from, to) = if up > down { (a, b) } else { (b, a) };
        (0..up.abs_diff(down)).for_each(|_| next.entry(from).or_default().push(to));
    }
    let mut holes = Vec::new();
    // A way along the edges; wherever it comes back to one of its points, the loop from there is a hole.
    let mut way: Vec<usize> = Vec::new();
    let mut place: BTreeMap<usize, usize> = BTreeMap::new();
    // The least point first: holes are found in an order that depends on the surface alone.
    while let Some((&start, _)) = next.first_key_value() {
        let mut at = start;
        loop {
            if let Some(first) = place.get(&at).copied() {
                let points = way.split_off(first);
                place.retain(|_, at| *at < first);
                holes.push(Hole::closed(triangles, points));
            }
            place.insert(at, way.len());
            way.push(at);
            let Some(ends) = next.get_mut(&at) else { break };
            let to = ends.pop();
            if ends.is_empty() {
                next.remove(&at);
            }
            // As many edges lead away from a point as to it.
            let Some(to) = to else { break };
            at = to;
        }
        way.clear();
        place.clear();
    }
    holes
}

impl Hole {
    /// Closes a loop with triangles between its points alone: again and again the two neighbours of a point are joined that are nearest to each
    /// other, which zips up slits and leaves round holes nearly flat.
    fn closed(triangles: &Triangles, points: Vec<usize>) -> Hole {
        let count = points.len();
        let mut hole = Hole { points, cap: Vec::new(), area: 0.0 };
        let mut neighbours: Vec<[usize; 2]> = (0..count).map(|i| [(i + count - 1) % count, (i + 1) % count]).collect();
        let mut is_left = vec![true; count];
        let chord = |[a, b]: [usize; 2]| {
            let [p, q] = [a, b].map(|i| triangles.points[hole.points[i]]);
            // The bits of positive numbers are in the order of the numbers.
            distance(&p, &q).to_bits()
        };
        let mut nearest: BinaryHeap<Reverse<(u64, usize, [usize; 2])>> =
            (0..count).map(|i| Reverse((chord(neighbours[i]), i, neighbours[i]))).collect();
        let mut rest = count;
        while let Some(Reverse((_, i, ends))) = nearest.pop() {
            if rest < 3 {
                break;
            }
            // The neighbours have changed since this entry was made, and a later one has the chord as it is now.
            if !is_left[i] || neighbours[i] != ends {
                continue;
            }
            let [before, after] = ends;
            // The surface passes the loop from before to after; what closes it passes it back.
            hole.cap.push([after, i, before].map(|i| hole.points[i]));
            is_left[i] = false;
            rest -= 1;
            neighbours[before][1] = after;
            neighbours[after][0] = before;
            for end in [before, after] {
                nearest.push(Reverse((chord(neighbours[end]), end, neighbours[end])));
            }
        }
        hole.area = hole.cap.iter().map(|&t| triangles.area(t)).sum();
        hole
    }

    /// The length of the loop, m.
    pub fn length(&self, triangles: &Triangles) -> f64 {
        let count = self.points.len();
        let along = |i: usize| [i, (i + 1) % count].map(|i| triangles.points[self.points[i]]);
        (0..count).map(along).map(|[p, q]| distance(&p, &q)).sum()
    }
}
