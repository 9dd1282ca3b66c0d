//! Springs of neighbouring points, which are evaluated on one thread.

use super::contents::{Contents, ContentsRoom, is_measured_by_quadrature};
use super::edges::{Bars, Edges, is_bar};
use super::simplices::{Simplices, Tensions, measures_simplices};
use super::strains::{Strains, is_strain};
use super::turns::{Folds, is_fold};
use crate::model::network::{LengthSpring, MeasureSpring, Network};
use crate::scalar::{Coordinate, Coordinates, CoordinatesWork, with_coordinates};

/// The number of springs of a part: long enough that threads need not wait for small pieces of work, and near each other in memory.
const SPRINGS: usize = 1 << 14;

/// Some springs of a network, sorted by kind.
#[derive(Debug)]
pub struct Part<N> {
    /// The points of the springs in the order of their rows.
    order: Vec<usize>,
    /// Whether the rows are all points as they are numbered.
    is_in_order: bool,
    edges: Edges<N>,
    bars: Bars<N>,
    simplices: Simplices<N>,
    contents: Contents,
    strains: Strains<N>,
    folds: Folds,
}

/// What an evaluation of a part needs.
#[derive(Debug, Default)]
pub struct Room<N> {
    /// The positions of the rows, with one unused number each.
    x: Vec<[N; 4]>,
    /// The forces on the rows as (z, x, y), which is the order of cross products without a last permutation, and an unused number.
    force: Vec<[N; 4]>,
    work: Work,
}

/// What an evaluation computes before the forces.
#[derive(Debug, Default)]
pub struct Work {
    tensions: Tensions,
    contents: ContentsRoom,
}

/// The parts of a network whose points are in this order, and the indices of its other springs that no part evaluates. They depend on
/// the network alone, so that sums do.
pub fn parts<N: Coordinate>(network: &Network, order: &[usize]) -> (Vec<Part<N>>, Vec<usize>) {
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
    // Even shares: the last part would else have what is left over, and the others wait.
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
            spring if measures_simplices(spring, network.dimension) => &mut draft.cells,
            spring if is_bar(spring) => &mut draft.bars,
            spring if is_measured_by_quadrature(spring) => &mut draft.contents,
            spring if is_strain(spring) => &mut draft.strains,
            spring if is_fold(spring) && network.dimension == 3 => &mut draft.folds,
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
    strains: Vec<usize>,
    folds: Vec<usize>,
}

impl Draft<'_> {
    /// `place` is the row of each point in the whole network.
    fn finish<N: Coordinate>(self, network: &Network, place: &[usize]) -> Part<N> {
        let Draft { lengths, cells, bars, contents, strains, folds } = self;
        let of_measures = [&cells, &bars, &contents, &strains, &folds];
        let others = of_measures.into_iter().flatten().flat_map(|s| &network.others[*s].points);
        let mut order: Vec<usize> = lengths.iter().flat_map(|spring| &spring.points).chain(others).copied().collect();
        // Equal entries are the same point, and leave with the next line.
        order.sort_unstable_by_key(|point| place[*point]);
        order.dedup();
        let mut own = vec![usize::MAX; place.len()];
        order.iter().enumerate().for_each(|(row, &point)| own[point] = row);
        Part {
            edges: Edges::new(&lengths, &own, order.len()),
            bars: Bars::new(&lengths, &network.others, &bars, &own),
            simplices: Simplices::new(network, &cells, &own),
            contents: Contents::new(network, &contents, &own),
            strains: Strains::new(network, &strains, &own),
            folds: Folds::new(network, &folds, &own),
            is_in_order: order.iter().copied().eq(0..order.len()),
            order,
        }
    }
}

impl<N: Coordinate> Part<N> {
    /// Works the forces on its rows out with the points at these positions; false if a spring has none.
    pub fn pull(
        &self,
        dimension: usize,
        others: &[MeasureSpring],
        position: impl Fn(usize) -> [N; 4],
        room: &mut Room<N>,
    ) -> bool {
        let Room { x, force, work } = room;
        x.clear();
        x.extend(self.order.iter().map(|&point| position(point)));
        force.resize(x.len(), [N::zero(); 4]);
        self.pull_rows(dimension, others, x, force, work)
    }

    /// Computes the forces on the rows from the positions `x` of the rows, and writes them; false if a spring has none.
    pub fn pull_rows(
        &self,
        dimension: usize,
        others: &[MeasureSpring],
        x: &[[N; 4]],
        force: &mut [[N; 4]],
        work: &mut Work,
    ) -> bool {
        match dimension {
            1 => with_coordinates(Pull::<N, 1> { part: self, others, x, force, work }),
            2 => with_coordinates(Pull::<N, 2> { part: self, others, x, force, work }),
            _ => with_coordinates(Pull::<N, 3> { part: self, others, x, force, work }),
        }
    }

    /// The points of its springs in the order of their rows.
    pub fn points(&self) -> &[usize] {
        &self.order
    }

    /// Whether its rows are this number of points as they are numbered.
    pub fn is_all_of(&self, points: usize) -> bool {
        self.is_in_order && self.order.len() == points
    }
}

impl<N: Coordinate> Room<N> {
    /// The force on a row that was worked out last, as (z, x, y), and an unused number.
    #[inline(always)]
    pub fn force(&self, row: u32) -> &[N; 4] {
        &self.force[row as usize]
    }

    /// Memory for evaluations whose positions and forces are elsewhere.
    pub fn work(&mut self) -> &mut Work {
        &mut self.work
    }
}

/// One evaluation.
struct Pull<'a, N, const D: usize> {
    part: &'a Part<N>,
    others: &'a [MeasureSpring],
    x: &'a [[N; 4]],
    force: &'a mut [[N; 4]],
    work: &'a mut Work,
}

impl<N: Coordinate, const D: usize> CoordinatesWork<N> for Pull<'_, N, D> {
    type Output = bool;

    #[inline(always)]
    fn run<C: Coordinates<N>>(self, zero: C) -> bool {
        let Pull { part, others, x, force, work } = self;
        part.edges.pull(zero, x, force);
        let mut sound = part.bars.pull(zero, others, x, force);
        sound &= part.simplices.pull::<C, D>(zero, others, x, &mut work.tensions, force);
        sound &= part.contents.pull(D, others, x, &mut work.contents, force);
        sound &= part.strains.pull(zero, x, force);
        sound &= part.folds.pull(x, force);
        sound
    }
}
