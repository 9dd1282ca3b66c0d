//! Finds cells and sides that have the same points.

use super::mesh::{CellIndex, Mesh, SideIndex};
use crate::random::mix;
use rayon::prelude::*;

impl Mesh {
    /// Calls `visit` for each set of points with the sides of the body's cells that have it, in the order of the cells. The sets have no order.
    pub fn each_side_set(&self, mut visit: impl FnMut(&[SideIndex])) {
        let mut sides = vec![0; self.blocks.len()];
        self.body_blocks().for_each(|(index, block)| sides[index] = block.element.sides().len());
        let counts = self.blocks.iter().zip(&sides).map(|(block, sides)| block.cells().len() * sides);
        let (starts, count) = running_sums(counts);
        let side = |item: usize| {
            let block = starts.partition_point(|start| *start <= item) - 1;
            let (cell, side) = ((item - starts[block]) / sides[block], (item - starts[block]) % sides[block]);
            SideIndex { cell: CellIndex { block, cell }, side }
        };
        let points = |item: usize, set: &mut Vec<usize>| set.extend(self.side_points(&side(item)));
        let mut own = Vec::new();
        each_set(count, self.point_count(), points, |items| {
            own.clear();
            own.extend(items.iter().map(|&item| side(item)));
            visit(&own);
        });
    }

    /// Calls `visit` for each set of points with the cells that have it, in their order; point p counts as `place(p)`.
    pub(super) fn each_cell_set(&self, place: impl Fn(usize) -> usize, mut visit: impl FnMut(&[CellIndex])) {
        let (starts, count) = running_sums(self.blocks.iter().map(|block| block.cells().len()));
        let cell = |item: usize| {
            let block = starts.partition_point(|start| *start <= item) - 1;
            CellIndex { block, cell: item - starts[block] }
        };
        let points =
            |item: usize, set: &mut Vec<usize>| set.extend(self.cell_nodes(cell(item)).iter().map(|&p| place(p)));
        let mut own = Vec::new();
        each_set(count, self.point_count(), points, |items| {
            own.clear();
            own.extend(items.iter().map(|&item| cell(item)));
            visit(&own);
        });
    }
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

/// Calls `visit` for each set of points with the items of 0 … `count` − 1 that have it, ascending. `points(item)` writes the points of an
/// item in any order; they are below `bound`.
///
/// Items are sorted as single numbers: the high bits are the lowest point, so that the items of a set are near each other in memory, then
/// comes a hash of the set, which does not depend on the order of its points, and the low bits are the item. Points have few items each, so
/// that these are counted, put beside each other, and sorted in short lists.
fn each_set(count: usize, bound: usize, points: impl Fn(usize, &mut Vec<usize>), mut visit: impl FnMut(&[usize])) {
    let of_item = usize::BITS - count.leading_zeros();
    let of_hash = (u64::BITS - of_item).saturating_sub(usize::BITS - bound.leading_zeros()).max(1);
    let mut set = Vec::new();
    let key = |item: usize| {
        set.clear();
        points(item, &mut set);
        // A sum of mixed numbers does not depend on the order in which a cell names its points, and needs no sorting.
        let hash = set.iter().fold(0u64, |sum, &p| sum.wrapping_add(mix(p as u64)));
        let lowest = set.iter().copied().min().unwrap_or(0) as u64;
        (lowest << of_hash | hash >> (u64::BITS - of_hash)) << of_item | item as u64
    };
    let keys: Vec<u64> = (0..count).map(key).collect();
    // No more than the bits of all points.
    let lowest = |key: &u64| key.checked_shr(of_item + of_hash).unwrap_or(0) as usize;
    // Counts of 32 bits take half of the memory; sides of more than 2³² would not fit into it by far.
    let mut next = vec![0_u32; keys.iter().map(lowest).max().map_or(0, |most| most + 2)];
    keys.iter().for_each(|key| next[lowest(key) + 1] += 1);
    (1..next.len()).for_each(|point| next[point] += next[point - 1]);
    let mut sorted = vec![0; count];
    for key in &keys {
        let place = &mut next[lowest(key)];
        // The lists are then sorted on all threads; the keys have no equal ones, so that the order is the same in each run.
        sorted[*place as usize] = *key;
        *place += 1;
    }
    // A large mesh has many sides: one of the long lists is given back.
    drop(keys);
    let mut keys = sorted;
    keys.par_chunk_by_mut(|a, b| lowest(a) == lowest(b)).for_each(<[u64]>::sort_unstable);
    let item = |key: &u64| (key & ((1 << of_item) - 1)) as usize;
    let sorted = |item: usize, set: &mut Vec<usize>| {
        set.clear();
        points(item, set);
        set.sort_unstable();
    };
    let [mut own, mut other, mut same, mut rest] = [const { Vec::new() }; 4];
    for run in keys.chunk_by(|a, b| a >> of_item == b >> of_item) {
        if let [key] = run {
            visit(&[item(key)]);
            continue;
        }
        // Different sets may have the same hash.
        rest.clear();
        rest.extend(run.iter().map(item));
        while let Some(&first) = rest.first() {
            sorted(first, &mut own);
            same.clear();
            rest.retain(|&item| {
                sorted(item, &mut other);
                let differs = own != other;
                same.extend((!differs).then_some(item));
                differs
            });
            visit(&same);
        }
    }
}
