//! A network prepared for many evaluations of its forces, as a simulation requires: its points are in an order that
//! keeps neighbours together, and its springs are sorted by kind.

mod branches;
mod contents;
mod edges;
mod laws;
mod part;
mod roots;
mod simplices;
mod sources;
mod strains;
mod tables;
mod tangents;
mod turns;

pub(crate) use branches::{BranchRule, Branches};

use super::network::Network;
use super::numbering::places;
use super::rows::{RowForces, Rows};
use super::{BlockStiffness, Elastic, Response};
use crate::scalar::{Coordinate, of_dimension};
use part::{Part, Room, parts};
use rayon::prelude::*;
use sources::Sources;
use std::sync::Mutex;

/// The network with faster loops and the same results up to rounding. Springs on lengths, on contents of cells and of their
/// quadrature points, on fibres, on patches of simplices, on strains and on turns are evaluated in a fraction of the time; a large network is evaluated in parts
/// on all threads, with the same bits on any number of them. It owns the memory of one evaluation; others at the same time take their own.
///
/// N are the numbers of its forces: with `f32` they are rounded to 6·10⁻⁸ of what its springs would pull if they measured from zero.
#[derive(Debug)]
pub struct PreparedNetwork<'a, N = f64> {
    network: &'a Network,
    parts: Vec<Part<N>>,
    sources: Sources,
    /// The indices of the other springs that are evaluated without preparation.
    rest: Vec<usize>,
    rooms: Mutex<Vec<Room<N>>>,
}

impl Network {
    /// Sorts the springs for [`Elastic::forces`]; this costs about as much as a hundred evaluations.
    pub fn prepared(&self) -> PreparedNetwork<'_> {
        PreparedNetwork::new(self)
    }

    /// Sorts the springs for [`Elastic::forces`] in numbers of the kind `N`.
    pub fn prepared_in<N: Precision>(&self) -> Box<dyn Elastic + '_> {
        N::prepare(self)
    }
}

/// The numbers of a prepared network: `f64` or `f32`.
pub trait Precision: Coordinate {
    /// The network prepared in these numbers.
    fn prepare(network: &Network) -> Box<dyn Elastic + '_>;
}

impl<'a, N: Coordinate> PreparedNetwork<'a, N> {
    fn new(network: &'a Network) -> PreparedNetwork<'a, N> {
        let (parts, rest) = parts(network, &order(network));
        let sources = Sources::new(&parts);
        PreparedNetwork { network, parts, sources, rest, rooms: Mutex::default() }
    }

    /// The forces as [`Elastic::forces`].
    fn add_up(&self, x: &[f64], force: &mut [f64]) -> bool {
        let sound = of_dimension!(self.network.dimension, |D| self.forces_in::<D>(x, force));
        let others = &self.network.others;
        // Without a short cut, so that the forces are complete.
        sound & self.network.add_others(self.rest.iter().map(|&s| &others[s]), x, force)
    }

    /// The forces as [`RowForces::pull_rows`].
    fn add_up_rows(&self, x: &[[N; 4]], force: &mut [[N; 4]]) -> bool {
        self.with_rooms(|rooms| match &self.parts[..] {
            // No row has to be moved.
            [part] if part.is_all_of(x.len()) => {
                part.pull_rows(self.network.dimension, &self.network.others, x, force, rooms[0].work())
            }
            _ => {
                let sound = self.pull(|point| x[point], rooms);
                self.sources.gather(rooms, force, |point, sum| *point = sum);
                sound
            }
        })
    }

    /// Evaluates the parts with the points at these positions; false if a spring has no force.
    fn pull(&self, position: impl Fn(usize) -> [N; 4] + Sync, rooms: &mut [Room<N>]) -> bool {
        let (d, others) = (self.network.dimension, &self.network.others);
        let pull = |(part, room): (&Part<N>, &mut Room<N>)| part.pull(d, others, &position, room);
        match &self.parts[..] {
            [part] => pull((part, &mut rooms[0])),
            // Each part has a room of its own; their forces are added later, in the order of the parts.
            parts => parts.par_iter().zip(rooms).map(pull).reduce(|| true, |a, b| a & b),
        }
    }

    /// Calls `evaluate` with memory for the parts.
    fn with_rooms<T>(&self, evaluate: impl FnOnce(&mut [Room<N>]) -> T) -> T {
        let mut kept = self.rooms.try_lock();
        let mut own = Vec::new();
        // A thread that waited here could hold up the parts of the evaluation that it waits for.
        let rooms = kept.as_deref_mut().unwrap_or(&mut own);
        rooms.resize_with(self.parts.len(), Room::default);
        evaluate(rooms)
    }

    /// The forces of the prepared springs.
    fn forces_in<const D: usize>(&self, x: &[f64], force: &mut [f64]) -> bool {
        let points = x.as_chunks::<D>().0;
        let origin = origin::<N>(x, D);
        let position = |point: usize| {
            let mut row = [N::zero(); 4];
            (0..D).for_each(|k| row[k] = N::of(points[point][k] - origin[k]));
            row
        };
        self.with_rooms(|rooms| {
            let sound = self.pull(position, rooms);
            self.sources.gather(rooms, force.as_chunks_mut::<D>().0, |point, sum| {
                (0..D).for_each(|k| point[k] = sum[(k + 1) % 3].wide());
            });
            sound
        })
    }
}

/// The place from which positions `[points × dimension]` are measured: springs see their differences alone.
pub(crate) fn origin<N: Coordinate>(x: &[f64], dimension: usize) -> [f64; 3] {
    std::array::from_fn(|k| if N::IS_SHORT && k < dimension { x.get(k).copied().unwrap_or(0.0) } else { 0.0 })
}

/// The order of the points: as they are numbered, or the order from the outside in if it brings neighbours nearer to
/// each other.
fn order(network: &Network) -> Vec<usize> {
    let lengths = network.lengths.iter().map(|s| (s.points[0], s.points[1]));
    // The points of a patch are connected through its cells, which other springs join.
    let others = network.others.iter().flat_map(|s| s.points.iter().map(move |&p| (s.points[0], p)));
    let pairs: Vec<(usize, usize)> = lengths.chain(others).collect();
    let count = pairs.iter().map(|(i, j)| i.max(j) + 1).max().unwrap_or(0);
    let mut is_used = vec![false; count];
    pairs.iter().for_each(|&(i, j)| (is_used[i], is_used[j]) = (true, true));
    let place = places(&pairs, &is_used);
    let given: Vec<usize> = (0..count).filter(|&p| is_used[p]).collect();
    let distance =
        |place: &dyn Fn(usize) -> usize| -> usize { pairs.iter().map(|&(i, j)| place(i).abs_diff(place(j))).sum() };
    if distance(&|p| p) <= distance(&|p| place[p]) {
        return given;
    }
    let mut order = given;
    order.sort_by_key(|&p| place[p]);
    order
}

/// Each kind of number has functions of its own and not generic ones, so that its loops are compiled, and optimised, with this crate.
macro_rules! precision {
    ($number:ty, $rows:ident) => {
        impl Precision for $number {
            fn prepare(network: &Network) -> Box<dyn Elastic + '_> {
                Box::new(PreparedNetwork::<$number>::new(network))
            }
        }

        impl RowForces<$number> for PreparedNetwork<'_, $number> {
            fn pull_rows(&self, x: &[[$number; 4]], force: &mut [[$number; 4]]) -> bool {
                self.add_up_rows(x, force)
            }
        }

        impl Elastic for PreparedNetwork<'_, $number> {
            fn respond(&self, x: &[f64]) -> Option<Response> {
                self.network.respond(x)
            }

            fn energy(&self, x: &[f64]) -> Option<f64> {
                Elastic::energy(self.network, x)
            }

            fn forces(&self, x: &[f64], force: &mut [f64]) -> bool {
                self.add_up(x, force)
            }

            fn rows(&self) -> Option<Rows<'_>> {
                // Springs that are evaluated without preparation read and write lists, not rows.
                self.rest.is_empty().then(|| Rows::$rows(self))
            }

            fn blocks(&self, x: &[f64]) -> Option<BlockStiffness> {
                self.network.blocks(x)
            }

            fn refill(&self, x: &[f64], force: &mut [f64], tangent: &mut [f64]) -> Option<f64> {
                self.network.refill(x, force, tangent)
            }

            fn refill_definite(&self, x: &[f64], force: &mut [f64], tangent: &mut [f64]) -> Option<f64> {
                self.network.refill_definite(x, force, tangent)
            }
        }
    };
}

precision!(f64, Double);
precision!(f32, Single);
