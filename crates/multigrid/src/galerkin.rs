//! The matrix of the next level, `Pᵀ A P`.

use crate::block::{Block, add_block_product, add_transposed_block_product, transposed, zero};
use crate::matrix::BlockMatrix;
use crate::parallel::{fill_rows, list_rows, vectorized};
use crate::pattern::Pattern;
use std::sync::Arc;

/// Bytes of `A P` that are in memory at a time, about.
// Rows of `A P` at the border of two batches are worked out for both, so that small batches cost work. Beside the levels of a body
// that fills a machine 128 MB do not count.
const ROOM: usize = 1 << 27;
const ABSENT: u32 = u32::MAX;

/// Places of columns in a row that is being summed.
struct Marks {
    /// By column; [`ABSENT`] outside the row.
    place: Vec<u32>,
}

impl Marks {
    fn new(width: usize) -> Marks {
        Marks { place: vec![ABSENT; width] }
    }

    fn clear(&mut self, columns: &[u32]) {
        columns.iter().for_each(|&column| self.place[column as usize] = ABSENT);
    }
}

/// `Pᵀ A P`; `rows_of` and `places` are [`Pattern::transposed`] of P. The rows of `A P` around some rows of the result are worked out at
/// a time. Only the upper triangle is summed; the lower one is the same to the last bit.
pub(crate) fn galerkin<const R: usize, const C: usize>(
    a: &BlockMatrix<R, R>,
    p: &BlockMatrix<R, C>,
    rows_of: &[usize],
    places: &[[u32; 2]],
) -> BlockMatrix<C, C> {
    let count = p.pattern.width;
    let around = |coarse: usize| &places[rows_of[coarse]..rows_of[coarse + 1]];
    // Rows of the result at a time, so that the rows of A P around them take ROOM: a row of A P has some four times the blocks of P's.
    let each = 4 * p.values.len() * size_of::<Block<R, C>>() / count.max(1);
    // Not fewer rows than threads can share.
    let batch = (ROOM / each.max(1)).clamp(256, count.max(256));
    let mut local = vec![ABSENT; a.rows()];
    let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for first in (0..count).step_by(batch) {
        let end = (first + batch).min(count);
        let mut fine: Vec<u32> = (first..end).flat_map(around).map(|[row, _]| *row).collect();
        fine.sort_unstable();
        fine.dedup();
        fine.iter().enumerate().for_each(|(i, &row)| local[row as usize] = i as u32);
        let ap = product(a, p, &fine);
        // Columns of each row of the upper triangle, ascending.
        let list = |marks: &mut Marks, row: usize, columns: &mut Vec<u32>| {
            let begin = columns.len();
            for &[i, _] in around(first + row) {
                for &column in ap.pattern.row(local[i as usize] as usize) {
                    if column as usize >= first + row && marks.place[column as usize] == ABSENT {
                        marks.place[column as usize] = 0;
                        columns.push(column);
                    }
                }
            }
            marks.clear(&columns[begin..]);
            // The columns come in an order that depends on the rows of A, whereas places are searched for in ascending ones.
            columns[begin..].sort_unstable();
        };
        let (own_starts, own_columns) = list_rows(end - first, || Marks::new(count), list);
        let mut own_values = vec![zero::<C, C>(); own_columns.len()];
        let fill = |marks: &mut Marks, row: usize, blocks: &mut [Block<C, C>]| {
            let columns = &own_columns[own_starts[row]..own_starts[row + 1]];
            columns.iter().enumerate().for_each(|(place, &column)| marks.place[column as usize] = place as u32);
            vectorized(
                #[inline(always)]
                || {
                    for &[i, at] in around(first + row) {
                        let i = local[i as usize] as usize;
                        for at_ap in ap.pattern.starts[i]..ap.pattern.starts[i + 1] {
                            let place = marks.place[ap.pattern.columns[at_ap] as usize];
                            // A block below the diagonal has no place: the upper triangle alone is summed.
                            if place != ABSENT {
                                let block = &mut blocks[place as usize];
                                add_transposed_block_product(block, &p.values[at as usize], &ap.values[at_ap]);
                            }
                        }
                    }
                },
            );
            marks.clear(columns);
        };
        fill_rows(&own_starts, &mut own_values, || Marks::new(count), fill);
        let before = columns.len();
        // Doubling would take twice the memory.
        columns.reserve_exact(own_columns.len());
        values.reserve_exact(own_values.len());
        starts.extend(own_starts[1..].iter().map(|start| before + start));
        columns.extend(own_columns);
        values.extend(own_values);
        // Only what was set is taken back. A new list for each batch would take time in proportion to all nodes.
        fine.iter().for_each(|&row| local[row as usize] = ABSENT);
    }
    mirrored(&Pattern { starts, columns, width: count }, &values)
}

/// Some rows of `A P`.
fn product<const R: usize, const C: usize>(
    a: &BlockMatrix<R, R>,
    p: &BlockMatrix<R, C>,
    rows: &[u32],
) -> BlockMatrix<R, C> {
    let width = p.pattern.width;
    let list = |marks: &mut Marks, row: usize, columns: &mut Vec<u32>| {
        let begin = columns.len();
        for &j in a.pattern.row(rows[row] as usize) {
            for &column in p.pattern.row(j as usize) {
                if marks.place[column as usize] == ABSENT {
                    marks.place[column as usize] = 0;
                    columns.push(column);
                }
            }
        }
        // The columns of A P stay as they were met: they are looked up by marks alone, and sorting them would serve nothing.
        marks.clear(&columns[begin..]);
    };
    let (starts, columns) = list_rows(rows.len(), || Marks::new(width), list);
    let mut values = vec![zero::<R, C>(); columns.len()];
    let fill = |marks: &mut Marks, row: usize, blocks: &mut [Block<R, C>]| {
        let columns = &columns[starts[row]..starts[row + 1]];
        columns.iter().enumerate().for_each(|(place, &column)| marks.place[column as usize] = place as u32);
        let row = rows[row] as usize;
        vectorized(
            #[inline(always)]
            || {
                for at in a.pattern.starts[row]..a.pattern.starts[row + 1] {
                    let j = a.pattern.columns[at] as usize;
                    for at_p in p.pattern.starts[j]..p.pattern.starts[j + 1] {
                        let place = marks.place[p.pattern.columns[at_p] as usize] as usize;
                        add_block_product(&mut blocks[place], &a.values[at], &p.values[at_p]);
                    }
                }
            },
        );
        marks.clear(columns);
    };
    fill_rows(&starts, &mut values, || Marks::new(width), fill);
    BlockMatrix { pattern: Arc::new(Pattern { starts, columns, width }), values }
}

/// Both triangles of a symmetric matrix, of the upper one.
fn mirrored<const N: usize>(upper: &Pattern, values: &[Block<N, N>]) -> BlockMatrix<N, N> {
    let rows = upper.rows();
    let (below_starts, below) = upper.transposed();
    let mut starts = vec![0];
    let count = 2 * values.len() - (0..rows).filter(|row| upper.row(*row).first() == Some(&(*row as u32))).count();
    let (mut columns, mut all) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for row in 0..rows {
        for &[column, at] in &below[below_starts[row]..below_starts[row + 1]] {
            if (column as usize) < row {
                columns.push(column);
                all.push(transposed(&values[at as usize]));
            }
        }
        for at in upper.starts[row]..upper.starts[row + 1] {
            columns.push(upper.columns[at]);
            let block = &values[at];
            let is_diagonal = upper.columns[at] as usize == row;
            // Both halves of a block on the diagonal are summed in other orders; their mean is symmetric to the last
            // bit.
            let half = |i: usize, j: usize| if is_diagonal { 0.5 * (block[i][j] + block[j][i]) } else { block[i][j] };
            all.push(std::array::from_fn(|i| std::array::from_fn(|j| half(i, j))));
        }
        starts.push(columns.len());
    }
    BlockMatrix { pattern: Arc::new(Pattern { starts, columns, width: rows }), values: all }
}
