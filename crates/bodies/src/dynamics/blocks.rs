//! A symmetric matrix of D × D blocks, one row of blocks per point, in an order that keeps neighbours together.

use crate::scalar::Coordinates;

/// One block, `[row][column]`: a row in a register, with zeros after its D numbers. Vectors have one row for each point, with zeros alike.
pub(super) type Block<const D: usize> = [[f64; 4]; D];

/// The pattern of blocks: those of the diagonal, and the `columns` of the other blocks of one row after the other.
#[derive(Debug, Clone)]
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
        // Matrices with more rows than a u32 counts are refused by their size before they are filled.
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

    /// The pattern that a factor has if it keeps the blocks which appear as rows of this pattern are eliminated, but not those
    /// that appear because of them: the next level of fill.
    pub fn filled(&self) -> Pattern {
        let mut pairs = Vec::new();
        for i in 0..self.rows() {
            let row = &self.columns[self.starts[i]..self.starts[i + 1]];
            for (at, &j) in row.iter().enumerate() {
                pairs.push((i, j as usize));
                // Eliminating row i couples all rows that i is coupled to with each other.
                pairs.extend(row[at + 1..].iter().map(|&k| (j as usize, k as usize)));
            }
        }
        let place: Vec<usize> = (0..self.rows()).collect();
        Pattern::new(&pairs, &place, self.rows())
    }

    /// `y ← A x`, and `x·A x`; `blocks` holds those of the diagonal first, then the others.
    #[inline(always)]
    pub fn multiply<C: Coordinates, const D: usize>(
        &self,
        zero: C,
        blocks: &[Block<D>],
        x: &[[f64; 4]],
        y: &mut [[f64; 4]],
    ) -> f64 {
        let (diagonal, beyond) = blocks.split_at(self.rows());
        y.fill([0.0; 4]);
        let mut energy = zero;
        for i in 0..self.rows() {
            let at = self.starts[i]..self.starts[i + 1];
            let own = x[i];
            let sum = plus_turned(zero.load(&y[i]), diagonal[i].map(|row| zero.load(&row)), &own);
            let mut products = [zero; 4];
            for (block, &j) in beyond[at.clone()].iter().zip(&self.columns[at]) {
                let j = j as usize;
                let block = block.map(|row| zero.load(&row));
                add_products(&mut products, block, zero.load(&x[j]));
                // Each block is read once, for itself and for its mirror image below the diagonal.
                plus_turned(zero.load(&y[j]), block, &own).store(&mut y[j]);
            }
            let sum = sum.plus(C::sums(products));
            sum.store(&mut y[i]);
            energy = energy.plus_products(sum, zero.load(&own));
        }
        energy.dot(zero.load(&[1.0; 4]))
    }
}

/// Adds the products of the entries of `B x` before they are summed: over all blocks of a row they are summed once.
#[inline(always)]
pub(super) fn add_products<C: Coordinates, const D: usize>(products: &mut [C; 4], block: [C; D], x: C) {
    (0..D).for_each(|k| products[k] = products[k].plus_products(block[k], x));
}

/// `y + Bᵀ x`.
#[inline(always)]
pub(super) fn plus_turned<C: Coordinates, const D: usize>(y: C, block: [C; D], x: &[f64; 4]) -> C {
    (0..D).fold(y, |sum, k| sum.plus_scaled(x[k], block[k]))
}
