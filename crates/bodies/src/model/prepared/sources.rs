//! The parts whose springs pull at each point.

use super::part::{Part, Room};
use crate::scalar::Coordinate;
use rayon::prelude::*;

/// Points whose forces one thread adds at a time.
// They are as many as the springs of a part (`part.rs`), for the same reason.
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
    pub fn new<N: Coordinate>(parts: &[Part<N>]) -> Sources {
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

    /// Writes the sum of the forces that the parts worked out last at each point, as (z, x, y) and an unused number.
    pub fn gather<N: Coordinate, F: Send>(
        &self,
        rooms: &[Room<N>],
        force: &mut [F],
        write: impl Fn(&mut F, [N; 4]) + Sync,
    ) {
        // Points beyond the last that has a spring.
        let (points, beyond) = force.split_at_mut(self.starts.len() - 1);
        beyond.iter_mut().for_each(|point| write(point, [N::zero(); 4]));
        let piece = |(points, starts): (&mut [F], &[u32])| {
            for (point, ends) in points.iter_mut().zip(starts.windows(2)) {
                let mut sum = [N::zero(); 4];
                // In the order of the parts, so that the sum has the same bits on any number of threads.
                for &[part, row] in &self.rows[ends[0] as usize..ends[1] as usize] {
                    let force = rooms[part as usize].force(row);
                    (0..4).for_each(|k| sum[k] = sum[k] + force[k]);
                }
                write(point, sum);
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
