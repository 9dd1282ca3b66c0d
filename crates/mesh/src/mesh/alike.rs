//! Finds cells and sides that have the same points.

use super::mesh::{CellIndex, Mesh, SideIndex};
use crate::random::mix;
use rayon::prelude::*;

impl Mesh {
    /// Calls `visit` for each set of points with the sides of the body's cells that have it, in the order of the cells. The sets have no order.
    pub fn each_side_set(&self, visit: impl FnMut(&[SideIndex])) {
        let mut sides = vec![0; self.blocks.len()];
        self.body_blocks().for_each(|(index, block)| sides[index] = block.element.sides().len());
        let counts = self.blocks.iter().zip(&sides).map(|(block, sides)| block.cells().len() * sides);
        let (starts, count) = running_sums(counts);
        each_set(&Sides { mesh: self, sides, starts, count }, self.point_count(), visit);
    }

    /// Calls `visit` for each set of points with the cells that have it, in their order; point p counts as `place(p)`.
    pub(super) fn each_cell_set(&self, place: impl Fn(usize) -> usize, visit: impl FnMut(&[CellIndex])) {
        let (starts, count) = running_sums(self.blocks.iter().map(|block| block.cells().len()));
        each_set(&Cells { mesh: self, place, starts, count }, self.point_count(), visit);
    }
}

/// Numbered items of points.
trait Items {
    type Index;
    fn count(&self) -> usize;
    /// Calls `visit` with the lowest point of each item, in their order.
    fn each_lowest(&self, visit: impl FnMut(usize));
    /// Calls `visit` with the lowest point of each item and a hash of its points, in their order.
    fn each_hash(&self, visit: impl FnMut(usize, u64));
    fn index(&self, item: usize) -> Self::Index;
    /// The points of an item, in any order.
    fn points(&self, index: &Self::Index) -> impl Iterator<Item = usize>;
}

/// The sides of the body's cells.
struct Sides<'a> {
    mesh: &'a Mesh,
    /// How many sides a cell of each block has, and the number of its first one.
    sides: Vec<usize>,
    starts: Vec<usize>,
    count: usize,
}

impl Items for Sides<'_> {
    type Index = SideIndex;

    fn count(&self) -> usize {
        self.count
    }

    fn each_lowest(&self, mut visit: impl FnMut(usize)) {
        for (_, block) in self.mesh.body_blocks() {
            let sides = block.element.sides();
            for nodes in block.cells() {
                sides.iter().for_each(|side| visit(lowest(side.nodes.iter().map(|&a| nodes[a]))));
            }
        }
    }

    fn each_hash(&self, mut visit: impl FnMut(usize, u64)) {
        // A point is mixed once for all sides of its cell.
        let mut mixed = Vec::new();
        for (_, block) in self.mesh.body_blocks() {
            let sides = block.element.sides();
            for nodes in block.cells() {
                mixed.clear();
                mixed.extend(nodes.iter().map(|&p| mix(p as u64)));
                for side in sides {
                    visit(lowest(side.nodes.iter().map(|&a| nodes[a])), sum(side.nodes.iter().map(|&a| mixed[a])));
                }
            }
        }
    }

    fn index(&self, item: usize) -> SideIndex {
        let block = self.starts.partition_point(|start| *start <= item) - 1;
        let (item, sides) = (item - self.starts[block], self.sides[block]);
        SideIndex { cell: CellIndex { block, cell: item / sides }, side: item % sides }
    }

    fn points(&self, index: &SideIndex) -> impl Iterator<Item = usize> {
        self.mesh.side_points(index)
    }
}

/// The cells, whose points p count as `place(p)`.
struct Cells<'a, P> {
    mesh: &'a Mesh,
    place: P,
    /// The number of the first cell of each block.
    starts: Vec<usize>,
    count: usize,
}

impl<P: Fn(usize) -> usize> Items for Cells<'_, P> {
    type Index = CellIndex;

    fn count(&self) -> usize {
        self.count
    }

    fn each_lowest(&self, mut visit: impl FnMut(usize)) {
        let cells = self.mesh.blocks.iter().flat_map(|block| block.cells());
        cells.for_each(|nodes| visit(lowest(nodes.iter().map(|&p| (self.place)(p)))));
    }

    fn each_hash(&self, mut visit: impl FnMut(usize, u64)) {
        for nodes in self.mesh.blocks.iter().flat_map(|block| block.cells()) {
            let places = || nodes.iter().map(|&p| (self.place)(p));
            visit(lowest(places()), sum(places().map(|p| mix(p as u64))));
        }
    }

    fn index(&self, item: usize) -> CellIndex {
        let block = self.starts.partition_point(|start| *start <= item) - 1;
        CellIndex { block, cell: item - self.starts[block] }
    }

    fn points(&self, index: &CellIndex) -> impl Iterator<Item = usize> {
        self.mesh.cell_nodes(*index).iter().map(|&p| (self.place)(p))
    }
}

fn lowest(points: impl Iterator<Item = usize>) -> usize {
    points.min().unwrap_or(0)
}

/// The hash of points from their mixed numbers. It does not depend on the order in which a cell names its points, and needs no sorting.
fn sum(mixed: impl Iterator<Item = u64>) -> u64 {
    mixed.fold(0, u64::wrapping_add)
}

/// The sum of the counts before each, and of all.
fn running_sums(counts: impl Iterator<Item = usize>) -> (Vec<usize>, usize) {
    let mut sum = 0;
    let mut starts = Vec::new();
    for count in counts {
        starts.push(sum);
        sum += count;
    }
    (starts, sum)
}

/// Calls `visit` for each set of points with the items that have it, ascending. The points are below `bound`.
///
/// Items are sorted as single numbers: the high bits are the lowest point, so that the items of a set are near each other in memory, then
/// comes a hash of the set, which does not depend on the order of its points, and the low bits are the item. Points have few items each, so
/// that these are counted, put beside each other, and sorted in short lists.
fn each_set<I: Items>(items: &I, bound: usize, mut visit: impl FnMut(&[I::Index])) {
    let count = items.count();
    let of_item = usize::BITS - count.leading_zeros();
    let of_hash = (u64::BITS - of_item).saturating_sub(usize::BITS - bound.leading_zeros()).max(1);
    // Counts of 32 bits take half of the memory; sides of more than 2³² would not fit into it by far.
    let mut next = vec![0_u32; bound.max(1) + 1];
    items.each_lowest(|lowest| next[lowest + 1] += 1);
    (1..next.len()).for_each(|point| next[point] += next[point - 1]);
    let mut keys = vec![0_u64; count];
    let mut item = 0;
    // A second walk over the cells takes less time than a list of all keys in the first one, which is as long as all else.
    items.each_hash(|lowest, hash| {
        let place = &mut next[lowest];
        // The lists are then sorted on all threads; the keys have no equal ones, so that the order is the same in each run.
        keys[*place as usize] = ((lowest as u64) << of_hash | hash >> (u64::BITS - of_hash)) << of_item | item;
        *place += 1;
        item += 1;
    });
    // No more than the bits of all points.
    let lowest = |key: &u64| key.checked_shr(of_item + of_hash).unwrap_or(0);
    keys.par_chunk_by_mut(|a, b| lowest(a) == lowest(b)).for_each(<[u64]>::sort_unstable);
    let index = |key: &u64| items.index((key & ((1 << of_item) - 1)) as usize);
    let [mut run, mut same, mut rest] = [const { Vec::new() }; 3];
    let [mut own, mut other] = [const { Vec::new() }; 2];
    for keys in keys.chunk_by(|a, b| a >> of_item == b >> of_item) {
        run.extend(keys.iter().map(index));
        // Different sets may have the same hash.
        while run.len() > 1 {
            for index in run.drain(..) {
                let points = if same.is_empty() { &mut own } else { &mut other };
                points.clear();
                points.extend(items.points(&index));
                let is_same = same.is_empty() || are_alike(&own, &other);
                if is_same { &mut same } else { &mut rest }.push(index);
            }
            visit(&same);
            same.clear();
            std::mem::swap(&mut run, &mut rest);
        }
        if !run.is_empty() {
            visit(&run);
            run.clear();
        }
    }
}

/// Whether two short lists have the same points, each as often.
fn are_alike(a: &[usize], b: &[usize]) -> bool {
    let count = |points: &[usize], p: usize| points.iter().filter(|&&q| q == p).count();
    a.len() == b.len() && a.iter().all(|&p| count(a, p) == count(b, p))
}
