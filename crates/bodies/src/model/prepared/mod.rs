//! A network prepared for many evaluations of its forces, as a simulation requires: its points are in an order that
//! keeps neighbours together, and its springs are sorted by kind.

mod contents;
mod edges;
mod laws;
mod simplices;
mod tangents;

use super::network::Network;
use super::numbering::places;
use super::{Elastic, Response};
use crate::scalar::{Coordinates, CoordinatesWork, with_coordinates};
use contents::{Contents, ContentsRoom};
use edges::{Bars, Edges};
use simplices::{Simplices, Tensions};
use std::sync::{Mutex, PoisonError};

/// The network with faster loops and the same results up to rounding. Springs on lengths, on contents of cells and of their
/// quadrature points, on fibres, and on patches of simplices are evaluated in a fraction of the time. It owns the memory that an evaluation needs, so that threads wait for each other.
#[derive(Debug)]
pub struct PreparedNetwork<'a> {
    network: &'a Network,
    /// The points of the network in the order of their rows.
    order: Vec<usize>,
    edges: Edges,
    bars: Bars,
    simplices: Simplices,
    contents: Contents,
    /// The indices of the other springs that are evaluated without preparation.
    rest: Vec<usize>,
    room: Mutex<Room>,
}

#[derive(Debug, Default)]
struct Room {
    /// The positions of the rows, with one unused number each.
    x: Vec<[f64; 4]>,
    force: Vec<[f64; 4]>,
    tensions: Tensions,
    contents: ContentsRoom,
}

impl Network {
    /// Sorts the springs for [`Elastic::forces`]; this costs about as much as a hundred evaluations.
    pub fn prepared(&self) -> PreparedNetwork<'_> {
        PreparedNetwork::new(self)
    }
}

impl<'a> PreparedNetwork<'a> {
    fn new(network: &'a Network) -> PreparedNetwork<'a> {
        let [mut cells, mut lengths, mut contents, mut rest] = [const { Vec::new() }; 4];
        for (s, spring) in network.others.iter().enumerate() {
            let kind = match spring {
                spring if Simplices::have(spring, network.dimension) => &mut cells,
                spring if Bars::has(spring) => &mut lengths,
                spring if Contents::have(spring) => &mut contents,
                _ => &mut rest,
            };
            kind.push(s);
        }
        let order = order(network);
        let count = order.iter().max().map_or(0, |last| last + 1);
        let mut place = vec![usize::MAX; count];
        order.iter().enumerate().for_each(|(row, &point)| place[point] = row);
        PreparedNetwork {
            network,
            edges: Edges::new(network, &place, order.len()),
            bars: Bars::new(network, &lengths, &place),
            simplices: Simplices::new(network, &cells, &place),
            contents: Contents::new(network, &contents, &place),
            order,
            rest,
            room: Mutex::default(),
        }
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
        let mut room = self.room.lock().unwrap_or_else(PoisonError::into_inner);
        let mut sound = match self.network.dimension {
            1 => with_coordinates(Pull::<1> { model: self, room: &mut room, x, force }),
            2 => with_coordinates(Pull::<2> { model: self, room: &mut room, x, force }),
            _ => with_coordinates(Pull::<3> { model: self, room: &mut room, x, force }),
        };
        let rest = self.rest.iter().map(|&s| &self.network.others[s]);
        sound &= self.network.add_others(rest, x, force);
        sound
    }

    fn refill(&self, x: &[f64], force: &mut [f64], tangent: &mut [f64]) -> Option<f64> {
        self.network.refill(x, force, tangent)
    }

    fn refill_definite(&self, x: &[f64], force: &mut [f64], tangent: &mut [f64]) -> Option<f64> {
        self.network.refill_definite(x, force, tangent)
    }
}

/// One evaluation.
struct Pull<'a, const D: usize> {
    model: &'a PreparedNetwork<'a>,
    room: &'a mut Room,
    x: &'a [f64],
    force: &'a mut [f64],
}

impl<const D: usize> CoordinatesWork for Pull<'_, D> {
    type Output = bool;

    #[inline(always)]
    fn run<C: Coordinates>(self, zero: C) -> bool {
        let Pull { model, room, x, force } = self;
        let Room { x: rows, force: sums, tensions, contents } = room;
        let others = &model.network.others;
        rows.resize(model.order.len(), [0.0; 4]);
        sums.resize(model.order.len(), [0.0; 4]);
        pack::<D>(&model.order, x, rows);
        model.edges.pull(zero, rows, sums);
        let mut sound = model.bars.pull(zero, others, rows, sums);
        sound &= model.simplices.pull::<C, D>(zero, others, rows, tensions, sums);
        sound &= model.contents.pull(D, others, rows, contents, sums);
        unpack::<D>(&model.order, sums, force);
        sound
    }
}

#[inline(always)]
fn pack<const D: usize>(order: &[usize], x: &[f64], rows: &mut [[f64; 4]]) {
    let points = x.as_chunks::<D>().0;
    for (row, &point) in rows.iter_mut().zip(order) {
        row[..D].copy_from_slice(&points[point]);
    }
}

/// The forces of the rows are (z, x, y), which is the order of cross products without a last permutation.
#[inline(always)]
fn unpack<const D: usize>(order: &[usize], sums: &[[f64; 4]], force: &mut [f64]) {
    force.fill(0.0);
    let points = force.as_chunks_mut::<D>().0;
    for (sum, &point) in sums.iter().zip(order) {
        for k in 0..D {
            points[point][k] = sum[(k + 1) % 3];
        }
    }
}
