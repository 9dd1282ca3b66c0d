//! The smoothed prolongator `P = (I − ω D⁻¹ A) T`.

use crate::aggregation::{Aggregates, NONE};
use crate::block::{Block, add_block_product, zero};
use crate::matrix::BlockMatrix;
use crate::parallel::{fill_rows, list_rows, vectorized};
use crate::pattern::Pattern;
use crate::tentative::Tentative;
use std::sync::Arc;

/// `inverse` is D⁻¹, zero in what is held.
pub(crate) fn prolongator<const R: usize, const C: usize>(
    a: &BlockMatrix<R, R>,
    inverse: &[Block<R, R>],
    omega: f64,
    aggregates: &Aggregates,
    tentative: &Tentative<R, C>,
) -> BlockMatrix<R, C> {
    // A node that is held as a whole has no inverse, and a row of P without blocks.
    let moves = |row: usize| inverse[row].iter().flatten().any(|x| *x != 0.0);
    let list = |_: &mut (), row: usize, columns: &mut Vec<u32>| {
        if !moves(row) {
            return;
        }
        let first = columns.len();
        for &j in a.pattern.row(row) {
            let own = aggregates.of[j as usize];
            // A row has few columns: to look through them is faster than a set.
            if own != NONE && !columns[first..].contains(&own) {
                columns.push(own);
            }
        }
        columns[first..].sort_unstable();
    };
    let (starts, columns) = list_rows(a.rows(), || (), list);
    let pattern = Arc::new(Pattern { starts, columns, width: aggregates.count });
    let mut p = BlockMatrix::zero(pattern.clone());
    let fill = |sums: &mut Vec<Block<R, C>>, row: usize, blocks: &mut [Block<R, C>]| {
        vectorized(
            #[inline(always)]
            || {
                sums.clear();
                sums.resize(blocks.len(), zero());
                let columns = pattern.row(row);
                for at in a.pattern.starts[row]..a.pattern.starts[row + 1] {
                    let j = a.pattern.columns[at] as usize;
                    if let Some(place) = columns.iter().position(|own| *own == aggregates.of[j]) {
                        add_block_product(&mut sums[place], &a.values[at], &tentative.basis[j]);
                    }
                }
                for (block, sum) in blocks.iter_mut().zip(&*sums) {
                    // D⁻¹ comes after the sum over the neighbours: one product for each block of P in place of one for each block of A.
                    add_block_product(block, &inverse[row], sum);
                    block.as_flattened_mut().iter_mut().for_each(|x| *x *= -omega);
                }
                let own = aggregates.of[row];
                if let Some(place) = columns.iter().position(|column| *column == own) {
                    let t = tentative.basis[row].as_flattened();
                    blocks[place].as_flattened_mut().iter_mut().zip(t).for_each(|(p, t)| *p += t);
                }
            },
        );
    };
    fill_rows(&pattern.starts, &mut p.values, Vec::new, fill);
    p
}
