//! The order in which Jolt takes the constraints of a soft body once it has optimised their order: that of version 5.6, measured in its
//! JavaScript package 1.1.0.
//!
//! Points are divided into groups of 256. A sweep takes the springs inside groups before those across groups, in each of both those on contents
//! before those on lengths, and each of these by the distance to the nearest held point along springs, the least point, and their place.

use super::sequence::Sequence;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Points of a group.
// It is `SoftBodyUpdateContext::cVertexConstraintBatch` of Jolt: another number gives another order of the springs, and another body.
const GROUP: usize = 256;
/// Jolt computes in single precision, and ties are decided by its rounding.
type Place = [f32; 3];

impl<S: AsRef<[usize]>> Sequence<'_, S> {
    /// The springs in the order in which Jolt takes them.
    pub(super) fn order_of_jolt(&self) -> Vec<usize> {
        let places: Vec<Place> = self
            .points
            .chunks_exact(self.dimension)
            .map(|x| [0, 1, 2].map(|k| x.get(k).copied().unwrap_or(0.0) as f32))
            .collect();
        let (groups, distances) = (self.groups(&places), self.distances(&places));
        let key = |spring: usize| {
            let points = self.springs[spring].as_ref();
            let own = groups[points[0]];
            let is_inside = own.is_some() && points.iter().all(|&p| groups[p] == own);
            let group = if is_inside { own.unwrap_or(usize::MAX) } else { usize::MAX };
            let near = points.iter().map(|&p| distances[p]).fold(f32::MAX, f32::min);
            let least = points.iter().copied().min().unwrap_or(0);
            (group, spring < self.lengths, near, least, spring)
        };
        let mut keys: Vec<_> = (0..self.springs.len()).map(key).collect();
        // Springs on contents are those with false in the second place, and come first; those across groups have the
        // largest group.
        keys.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)).then((a.3, a.4).cmp(&(b.3, b.4))));
        keys.into_iter().map(|(.., spring)| spring).collect()
    }

    /// The group of each point; `None` of points whose springs all count as those across groups.
    fn groups(&self, places: &[Place]) -> Vec<Option<usize>> {
        let count = places.len();
        let mut links: Vec<Vec<(usize, usize)>> = vec![Vec::new(); count];
        let mut link = |a: usize, b: usize| {
            for (from, to) in [(a, b), (b, a)] {
                match links[from].iter_mut().find(|(point, _)| *point == to) {
                    Some((_, times)) => *times += 1,
                    None => links[from].push((to, 1)),
                }
            }
        };
        for spring in self.springs {
            let points = spring.as_ref();
            for a in 0..points.len() {
                for b in a + 1..points.len() {
                    link(points[a], points[b]);
                }
            }
        }
        let mut groups = vec![None; count];
        let (mut now, mut members) = (0, Vec::new());
        let mut ties = vec![0; count];
        while let Some(seed) = seed(places, &groups) {
            let mut next = Some(seed);
            while let Some(point) = next {
                members.push(point);
                groups[point] = Some(now);
                links[point].iter().for_each(|(other, times)| ties[*other] += times);
                // The first of those with most links to the group, and of these of the nearest to its first point.
                let mut best: Option<((usize, f32), usize)> = None;
                for (other, _) in members.iter().flat_map(|member: &usize| &links[*member]) {
                    if groups[*other].is_some() {
                        continue;
                    }
                    let key = (ties[*other], square(places[*other], places[members[0]]));
                    if best.is_none_or(|(known, _)| key.0 > known.0 || key.0 == known.0 && key.1 < known.1) {
                        best = Some((key, *other));
                    }
                }
                next = best.map(|(_, other)| other);
                if members.len() >= GROUP || members.len() > GROUP / 2 && next.is_none() {
                    members.clear();
                    ties.fill(0);
                    now += 1;
                    break;
                }
            }
        }
        // A last set of at most half a group is no group: its springs count as those across groups.
        if members.len() <= GROUP / 2 {
            groups.iter_mut().filter(|group| **group == Some(now)).for_each(|group| *group = None);
        }
        groups
    }

    /// The least way from each point to a held one along springs on lengths.
    fn distances(&self, places: &[Place]) -> Vec<f32> {
        let mut near: Vec<Vec<usize>> = vec![Vec::new(); places.len()];
        for spring in &self.springs[..self.lengths] {
            if let [a, b] = spring.as_ref()[..] {
                near[a].push(b);
                near[b].push(a);
            }
        }
        let mut distances = vec![f32::MAX; places.len()];
        let mut queue = BinaryHeap::new();
        for point in (0..places.len()).filter(|&p| self.held[p]) {
            distances[point] = 0.0;
            queue.push(Reached { distance: 0.0, point });
        }
        while let Some(Reached { distance, point }) = queue.pop() {
            // A nearer way was found after this entry went into the queue.
            if distance > distances[point] {
                continue;
            }
            for &other in &near[point] {
                let way = distance + square(places[point], places[other]).sqrt();
                if way < distances[other] {
                    distances[other] = way;
                    queue.push(Reached { distance: way, point: other });
                }
            }
        }
        distances
    }
}

/// The point that is first along the longest axis of the box of those without a group, then along the middle one, then the shortest.
fn seed(places: &[Place], groups: &[Option<usize>]) -> Option<usize> {
    let left = || (0..places.len()).filter(|&p| groups[p].is_none());
    let extent = [0, 1, 2].map(|k| {
        let along = || left().map(|p| places[p][k]);
        along().fold(f32::MIN, f32::max) - along().fold(f32::MAX, f32::min)
    });
    let [x, y, z] = extent;
    // The comparisons are those of Jolt's vectors, so that equal extents give the same axis.
    let longest = if x > y {
        if z > x { 2 } else { 0 }
    } else if z > y {
        2
    } else {
        1
    };
    let shortest = if x < y {
        if z < x { 2 } else { 0 }
    } else if z < y {
        2
    } else {
        1
    };
    // With three equal extents both are one axis.
    let shortest = if shortest == longest { (shortest + 1) % 3 } else { shortest };
    let axes = [longest, 3 - longest - shortest, shortest];
    let compare = |a: &usize, b: &usize| {
        axes.iter()
            .map(|&k| places[*a][k].total_cmp(&places[*b][k]))
            .find(|order| order.is_ne())
            .unwrap_or(Ordering::Equal)
    };
    left().min_by(compare)
}

fn square(a: Place, b: Place) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|k| a[k] - b[k]);
    x * x + y * y + z * z
}

/// A point in the queue, the nearest first.
struct Reached {
    distance: f32,
    point: usize,
}

impl PartialEq for Reached {
    fn eq(&self, other: &Reached) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Reached {}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Reached) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Reached {
    fn cmp(&self, other: &Reached) -> Ordering {
        // Turned round, because a heap gives its largest entry first.
        other.distance.total_cmp(&self.distance).then(other.point.cmp(&self.point))
    }
}
