//! The parts whose springs pull at each point.

use super::part::{Part, Room};
use rayon::prelude::*;

/// Points whose forces one thread adds at a time.
const POINTS: usize = 1 << 14;

/// The rows of the parts that belong to each point, so that threads which add the forces of some points do not meet.
#[derive(Debug)]
pub struct Sources {
    /// `[points + 1]`.
    starts: Vec<u32>,
    /// Part and row, by point and in the order of the parts.
    rows: Vec<[u32; 2]>,
}

impl Sources {
    pub fn new(parts: &[Part]) -> Sources {
        let points = || parts.iter().flat_map(Part::points).copied();
        let mut starts = vec![0; points().max().map_or(0, |last| last + 1) + 1];
        points().for_each(|point| starts[point + 1] += 1);
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        let (mut next, mut rows) = (starts.clone(), vec![[0; 2]; starts[starts.len() - 1] as usize]);
        for (p, part) in parts.iter().enumerate() {
            for (row, &point) in part.points().iter().enumerate() {
                rows[next[point] as usize] = [p as u32, row as u32];
                next[point] += 1;
            }
        }
        Sources { starts, rows }
    }

    /// The sum of the forces that the parts worked out last, at each point, `[points · dimension]`.
    pub fn gather(&self, dimension: usize, rooms: &[Room], force: &mut [f64]) {
        match dimension {
            1 => self.gather_in::<1>(rooms, force),
            2 => self.gather_in::<2>(rooms, force),
            _ => self.gather_in::<3>(rooms, force),
        }
    }

    fn gather_in<const D: usize>(&self, rooms: &[Room], force: &mut [f64]) {
        let (points, beyond) = force.as_chunks_mut::<D>().0.split_at_mut(self.starts.len() - 1);
        beyond.fill([0.0; D]);
        let piece = |(points, starts): (&mut [[f64; D]], &[u32])| {
            for (point, ends) in points.iter_mut().zip(starts.windows(2)) {
                *point = [0.0; D];
                for &[part, row] in &self.rows[ends[0] as usize..ends[1] as usize] {
                    let force = rooms[part as usize].force(row);
                    (0..D).for_each(|k| point[k] += force[(k + 1) % 3]);
                }
            }
        };
        match rooms {
            [_] => piece((points, &self.starts)),
            _ => {
                let starts = |at: usize| &self.starts[at * POINTS..];
                let pieces = points.par_chunks_mut(POINTS).enumerate();
                pieces.for_each(|(at, points)| piece((points, starts(at))));
            }
        }
    }
}
