//! A network prepared for many evaluations of its forces, as a simulation requires: its points are in an order that
//! keeps neighbours together, and its springs are sorted by kind.

mod contents;
mod edges;
mod laws;
mod part;
mod simplices;
mod sources;
mod tables;
mod tangents;

use super::network::Network;
use super::numbering::places;
use super::{BlockStiffness, Elastic, Response};
use part::{Part, Room, parts};
use rayon::prelude::*;
use sources::Sources;
use std::sync::Mutex;

/// The network with faster loops and the same results up to rounding. Springs on lengths, on contents of cells and of their
/// quadrature points, on fibres, and on patches of simplices are evaluated in a fraction of the time; a large network is evaluated in parts
/// on all threads, with the same bits on any number of them. It owns the memory of one evaluation; others at the same time take their own.
#[derive(Debug)]
pub struct PreparedNetwork<'a> {
    network: &'a Network,
    parts: Vec<Part>,
    sources: Sources,
    /// The indices of the other springs that are evaluated without preparation.
    rest: Vec<usize>,
    rooms: Mutex<Vec<Room>>,
}

impl Network {
    /// Sorts the springs for [`Elastic::forces`]; this costs about as much as a hundred evaluations.
    pub fn prepared(&self) -> PreparedNetwork<'_> {
        PreparedNetwork::new(self)
    }
}

impl<'a> PreparedNetwork<'a> {
    fn new(network: &'a Network) -> PreparedNetwork<'a> {
        let order = order(network);
        let (parts, rest) = parts(network, &order);
        let sources = Sources::new(&parts);
        PreparedNetwork { network, parts, sources, rest, rooms: Mutex::default() }
    }
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

impl Elastic for PreparedNetwork<'_> {
    fn respond(&self, x: &[f64]) -> Option<Response> {
        self.network.respond(x)
    }

    fn energy(&self, x: &[f64]) -> Option<f64> {
        Elastic::energy(self.network, x)
    }

    fn forces(&self, x: &[f64], force: &mut [f64]) -> bool {
        let others = &self.network.others;
        let mut kept = self.rooms.try_lock();
        let mut own = Vec::new();
        // A thread that waited here could hold up the parts of the evaluation that it waits for.
        let rooms = kept.as_deref_mut().unwrap_or(&mut own);
        rooms.resize_with(self.parts.len(), Room::default);
        let d = self.network.dimension;
        let pull = |(part, room): (&Part, &mut Room)| part.pull(d, others, x, room);
        let mut sound = match &self.parts[..] {
            [part] => pull((part, &mut rooms[0])),
            parts => parts.par_iter().zip(&mut rooms[..]).map(pull).reduce(|| true, |a, b| a & b),
        };
        self.sources.gather(d, rooms, force);
        sound &= self.network.add_others(self.rest.iter().map(|&s| &others[s]), x, force);
        sound
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
