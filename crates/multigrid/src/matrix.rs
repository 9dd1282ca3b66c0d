//! Matrices of dense blocks, stored row by row.

use crate::block::{Block, zero};
use crate::entry::Entry;
use crate::parallel::{PIECE, vectorized};
use crate::pattern::Pattern;
use rayon::prelude::*;
use std::sync::Arc;

/// A matrix of R × C blocks.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockMatrix<const R: usize, const C: usize> {
    pub(crate) pattern: Arc<Pattern>,
    pub(crate) values: Vec<Block<R, C>>,
}

impl<const R: usize, const C: usize> BlockMatrix<R, C> {
    /// All entries zero.
    pub fn zero(pattern: Arc<Pattern>) -> BlockMatrix<R, C> {
        let values = vec![zero(); pattern.len()];
        BlockMatrix { pattern, values }
    }

    /// Which blocks are stored.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// The blocks in the order of the pattern's columns.
    pub fn values(&self) -> &[Block<R, C>] {
        &self.values
    }

    /// Gives access to the blocks, in the order of the pattern's columns, so that they can be changed.
    pub fn values_mut(&mut self) -> &mut [Block<R, C>] {
        &mut self.values
    }

    /// Rows of blocks.
    pub fn rows(&self) -> usize {
        self.pattern.rows()
    }

    /// Bytes of the matrix.
    pub fn bytes(&self) -> usize {
        self.values.len() * (size_of::<Block<R, C>>() + size_of::<u32>())
            + self.pattern.starts.len() * size_of::<usize>()
    }

    /// `Σ_j A_ij x_j`.
    #[inline(always)]
    pub(crate) fn row_product<T: Entry>(&self, row: usize, x: &[[T; C]]) -> [T; R] {
        let range = self.pattern.starts[row]..self.pattern.starts[row + 1];
        T::row_product(&self.values[range.clone()], &self.pattern.columns[range], x)
    }

    /// `y ← A x`.
    pub fn apply(&self, x: &[[f64; C]], y: &mut [[f64; R]]) {
        self.product(x, y);
    }

    /// Computes `y ← A x` for one vector or for several.
    pub(crate) fn product<T: Entry>(&self, x: &[[T; C]], y: &mut [[T; R]]) {
        self.each_row(y, x, |y, product| *y = product);
    }

    /// Calls `set(y_i, (A x)_i)` for each row.
    pub(crate) fn each_row<T: Entry>(&self, y: &mut [[T; R]], x: &[[T; C]], set: impl Fn(&mut [T; R], [T; R]) + Sync) {
        // Each row is a sum of its own, so that threads do not change it.
        y.par_chunks_mut(PIECE).enumerate().for_each(|(piece, y)| {
            vectorized(
                #[inline(always)]
                || {
                    for (row, y) in (piece * PIECE..).zip(y) {
                        set(y, self.row_product(row, x));
                    }
                },
            );
        });
    }
}

impl<const N: usize> BlockMatrix<N, N> {
    /// The block of the diagonal.
    pub fn diagonal(&self, row: usize) -> Block<N, N> {
        self.pattern.place(row, row).map_or(zero(), |at| self.values[at])
    }
}
