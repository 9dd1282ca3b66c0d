//! A symmetric matrix of D × D blocks, one row of blocks per point, in an order that keeps neighbours together.

use std::array::from_fn;

/// One block, `[row][column]`.
pub(super) type Block<const D: usize> = [[f64; D]; D];

/// The pattern of blocks: those of the diagonal, and the `columns` of the other blocks of one row after the other.
#[derive(Debug)]
pub(super) struct Pattern {
    /// `[rows + 1]`.
    pub starts: Vec<usize>,
    /// Ascending in each row.
    pub columns: Vec<u32>,
}

impl Pattern {
    /// The pattern of the rows `place[i]` of the points i for which this is below `rows`.
    pub fn new(pairs: &[(usize, usize)], place: &[usize], rows: usize) -> Pattern {
        let row = |(i, j): &(usize, usize)| (place[*i].min(place[*j]), place[*i].max(place[*j]));
        let mut blocks: Vec<(usize, usize)> = pairs.iter().map(row).filter(|(a, b)| a < b && *b < rows).collect();
        blocks.sort_unstable();
        blocks.dedup();
        let mut starts = vec![0; rows + 1];
        blocks.iter().for_each(|(a, _)| starts[a + 1] += 1);
        (0..rows).for_each(|i| starts[i + 1] += starts[i]);
        Pattern { starts, columns: blocks.into_iter().map(|(_, b)| b as u32).collect() }
    }

    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// The index in `columns` of the off-diagonal block in this row and column.
    pub fn find(&self, row: usize, column: usize) -> Option<usize> {
        let columns = &self.columns[self.starts[row]..self.starts[row + 1]];
        columns.binary_search(&(column as u32)).ok().map(|at| self.starts[row] + at)
    }

    /// `y ← A x`; `blocks` holds those of the diagonal first, then the others.
    pub fn multiply<const D: usize>(&self, blocks: &[Block<D>], x: &[[f64; D]], y: &mut [[f64; D]]) {
        let (diagonal, beyond) = blocks.split_at(self.rows());
        y.iter_mut().zip(diagonal).zip(x).for_each(|((y, block), x)| *y = times(block, x));
        for i in 0..self.rows() {
            let at = self.starts[i]..self.starts[i + 1];
            let mut sum = y[i];
            for (block, &j) in beyond[at.clone()].iter().zip(&self.columns[at]) {
                let (j, part) = (j as usize, times(block, &x[j as usize]));
                (0..D).for_each(|k| sum[k] += part[k]);
                let part = turned_times(block, &x[i]);
                (0..D).for_each(|k| y[j][k] += part[k]);
            }
            y[i] = sum;
        }
    }
}

/// `B x`.
#[inline(always)]
pub(super) fn times<const D: usize>(block: &Block<D>, x: &[f64; D]) -> [f64; D] {
    from_fn(|k| (0..D).map(|l| block[k][l] * x[l]).sum())
}

/// `Bᵀ x`.
#[inline(always)]
pub(super) fn turned_times<const D: usize>(block: &Block<D>, x: &[f64; D]) -> [f64; D] {
    from_fn(|l| (0..D).map(|k| block[k][l] * x[k]).sum())
}
