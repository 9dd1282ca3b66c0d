//! Springs of neighbouring points, which are evaluated on one thread.

use super::contents::{Contents, ContentsRoom};
use super::edges::{Bars, Edges};
use super::simplices::{Simplices, Tensions};
use crate::model::network::{LengthSpring, MeasureSpring, Network};
use crate::scalar::{Coordinates, CoordinatesWork, with_coordinates};

/// The number of springs of a part: long enough that threads need not wait for small pieces of work, and near each other in memory.
const SPRINGS: usize = 1 << 14;

/// Some springs of a network, sorted by kind.
#[derive(Debug)]
pub struct Part {
    /// The points of the springs in the order of their rows.
    order: Vec<usize>,
    edges: Edges,
    bars: Bars,
    simplices: Simplices,
    contents: Contents,
}

/// What an evaluation of a part needs.
#[derive(Debug, Default)]
pub struct Room {
    /// The positions of the rows, with one unused number each.
    x: Vec<[f64; 4]>,
    force: Vec<[f64; 4]>,
    tensions: Tensions,
    contents: ContentsRoom,
}

/// The parts of a network whose points are in this order, and the indices of its other springs that no part evaluates. They depend on
/// the network alone, so that sums do.
pub fn parts(network: &Network, order: &[usize]) -> (Vec<Part>, Vec<usize>) {
    let count = order.iter().max().map_or(0, |last| last + 1);
    let mut place = vec![usize::MAX; count];
    order.iter().enumerate().for_each(|(row, &point)| place[point] = row);
    // A spring is with the first of its points.
    let first = |points: &[usize]| points.iter().map(|p| place[*p]).min().unwrap_or(0);
    let mut at = vec![0; order.len() + 1];
    let lengths = network.lengths.iter().map(|spring| first(&spring.points));
    let others = network.others.iter().map(|spring| first(&spring.points));
    lengths.chain(others).for_each(|row| at[row] += 1);
    let wanted = (network.lengths.len() + network.others.len()).div_ceil(SPRINGS).max(1);
    let share = (network.lengths.len() + network.others.len()).div_ceil(wanted).max(1);
    let mut before = 0;
    let part_of: Vec<usize> = at
        .iter()
        .map(|own| {
            before += own;
            (before - own) / share
        })
        .collect();
    let mut drafts = vec![Draft::default(); wanted];
    let mut rest = Vec::new();
    for spring in &network.lengths {
        drafts[part_of[first(&spring.points)]].lengths.push(spring);
    }
    for (s, spring) in network.others.iter().enumerate() {
        let draft = &mut drafts[part_of[first(&spring.points)]];
        let kind = match spring {
            spring if Simplices::have(spring, network.dimension) => &mut draft.cells,
            spring if Bars::has(spring) => &mut draft.bars,
            spring if Contents::have(spring) => &mut draft.contents,
            _ => &mut rest,
        };
        kind.push(s);
    }
    let own = |draft: Draft| draft.finish(network, &place);
    (drafts.into_iter().map(own).collect(), rest)
}

/// The springs of a part; those on measures by their indices.
#[derive(Debug, Clone, Default)]
struct Draft<'a> {
    lengths: Vec<&'a LengthSpring>,
    cells: Vec<usize>,
    bars: Vec<usize>,
    contents: Vec<usize>,
}

impl Draft<'_> {
    /// `place` is the row of each point in the whole network.
    fn finish(self, network: &Network, place: &[usize]) -> Part {
        let Draft { lengths, cells, bars, contents } = self;
        let others = [&cells, &bars, &contents].into_iter().flatten().flat_map(|s| &network.others[*s].points);
        let mut order: Vec<usize> = lengths.iter().flat_map(|spring| &spring.points).chain(others).copied().collect();
        order.sort_unstable_by_key(|point| place[*point]);
        order.dedup();
        let mut own = vec![usize::MAX; place.len()];
        order.iter().enumerate().for_each(|(row, &point)| own[point] = row);
        Part {
            edges: Edges::new(&lengths, &own, order.len()),
            bars: Bars::new(&lengths, &network.others, &bars, &own),
            simplices: Simplices::new(network, &cells, &own),
            contents: Contents::new(network, &contents, &own),
            order,
        }
    }
}

impl Part {
    /// Works the forces out with the points of the network at x; false if a spring has none.
    pub fn pull(&self, dimension: usize, others: &[MeasureSpring], x: &[f64], room: &mut Room) -> bool {
        match dimension {
            1 => with_coordinates(Pull::<1> { part: self, others, x, room }),
            2 => with_coordinates(Pull::<2> { part: self, others, x, room }),
            _ => with_coordinates(Pull::<3> { part: self, others, x, room }),
        }
    }

    /// The points of its springs in the order of their rows.
    pub fn points(&self) -> &[usize] {
        &self.order
    }
}

impl Room {
    /// The force on a row that was worked out last, as (z, x, y), which is the order of cross products without a last permutation, and an
    /// unused number.
    #[inline(always)]
    pub fn force(&self, row: u32) -> &[f64; 4] {
        &self.force[row as usize]
    }
}

/// One evaluation.
struct Pull<'a, const D: usize> {
    part: &'a Part,
    others: &'a [MeasureSpring],
    x: &'a [f64],
    room: &'a mut Room,
}

impl<const D: usize> CoordinatesWork for Pull<'_, D> {
    type Output = bool;

    #[inline(always)]
    fn run<C: Coordinates>(self, zero: C) -> bool {
        let Pull { part, others, x, room } = self;
        let Room { x: rows, force: sums, tensions, contents } = room;
        rows.resize(part.order.len(), [0.0; 4]);
        sums.resize(part.order.len(), [0.0; 4]);
        pack::<D>(&part.order, x, rows);
        part.edges.pull(zero, rows, sums);
        let mut sound = part.bars.pull(zero, others, rows, sums);
        sound &= part.simplices.pull::<C, D>(zero, others, rows, tensions, sums);
        sound &= part.contents.pull(D, others, rows, contents, sums);
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
