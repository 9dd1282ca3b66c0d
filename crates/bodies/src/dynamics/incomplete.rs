//! An incomplete Cholesky factorisation in blocks, the preconditioner of conjugate gradients.

use super::blocks::{Block, Pattern, times, turned_times};
use std::array::from_fn;

/// Shares of the diagonal that are added to it, in order, until no pivot is lost (Manteuffel 1980).
const SHIFTS: [f64; 8] = [0.0, 0.01, 0.03, 0.1, 0.3, 1.0, 10.0, 100.0];

/// `A ≈ (I + U)ᵀ E (I + U)`, with U of the off-diagonal pattern of A (Meijerink and van der Vorst 1977). With separate
/// pivots E a row waits for one product with the row before it, not for two.
#[derive(Debug)]
pub(super) struct Incomplete<const D: usize> {
    /// The pivots E, and then their inverses.
    pivots: Vec<Block<D>>,
    /// `E (I + U)` off the diagonal, and then U.
    beyond: Vec<Block<D>>,
    /// Triples `[p, q, t]`: block t loses `U_pᵀ E U_q`; of one row after the other.
    updates: Vec<[u32; 3]>,
    /// `[rows + 1]`.
    starts: Vec<usize>,
}

impl<const D: usize> Incomplete<D> {
    pub fn new(pattern: &Pattern) -> Incomplete<D> {
        let rows = pattern.rows();
        let (mut updates, mut starts) = (Vec::new(), vec![0]);
        for i in 0..rows {
            let row = pattern.starts[i]..pattern.starts[i + 1];
            for p in row.clone() {
                for q in p + 1..row.end {
                    if let Some(t) = pattern.find(pattern.columns[p] as usize, pattern.columns[q] as usize) {
                        updates.push([p as u32, q as u32, t as u32]);
                    }
                }
            }
            starts.push(updates.len());
        }
        let zeros = |count: usize| vec![[[0.0; D]; D]; count];
        Incomplete { pivots: zeros(rows), beyond: zeros(pattern.columns.len()), updates, starts }
    }

    /// Factorises A, given by its diagonal blocks first; false if it has no factor even with a hundred times its
    /// diagonal.
    pub fn refill(&mut self, pattern: &Pattern, blocks: &[Block<D>]) -> bool {
        SHIFTS.iter().any(|shift| self.factorize(pattern, blocks, 1.0 + shift))
    }

    fn factorize(&mut self, pattern: &Pattern, blocks: &[Block<D>], scale: f64) -> bool {
        let (diagonal, beyond) = blocks.split_at(pattern.rows());
        for (pivot, block) in self.pivots.iter_mut().zip(diagonal) {
            *pivot = block.map(|row| row.map(|x| scale * x));
        }
        self.beyond.copy_from_slice(beyond);
        for i in 0..pattern.rows() {
            let Some(inverse) = inverse(&self.pivots[i]) else { return false };
            self.pivots[i] = inverse;
            // Of the updates of a row those with p come before those with the next one: their U_p is complete.
            let mut updates = self.updates[self.starts[i]..self.starts[i + 1]].iter().peekable();
            for p in pattern.starts[i]..pattern.starts[i + 1] {
                let whole = self.beyond[p];
                let own = product(&inverse, &whole);
                subtract(&mut self.pivots[pattern.columns[p] as usize], &own, &whole);
                while let Some(&[_, q, t]) = updates.next_if(|update| update[0] as usize == p) {
                    let other = self.beyond[q as usize];
                    subtract(&mut self.beyond[t as usize], &own, &other);
                }
                self.beyond[p] = own;
            }
        }
        true
    }

    /// `z ← (I + U)⁻¹ E⁻¹ (I + U)⁻ᵀ z`.
    pub fn solve(&self, pattern: &Pattern, z: &mut [[f64; D]]) {
        for i in 0..pattern.rows() {
            let y = z[i];
            let at = pattern.starts[i]..pattern.starts[i + 1];
            for (block, &j) in self.beyond[at.clone()].iter().zip(&pattern.columns[at]) {
                let part = turned_times(block, &y);
                (0..D).for_each(|k| z[j as usize][k] -= part[k]);
            }
        }
        z.iter_mut().zip(&self.pivots).for_each(|(z, inverse)| *z = times(inverse, z));
        for i in (0..pattern.rows()).rev() {
            let mut y = z[i];
            let at = pattern.starts[i]..pattern.starts[i + 1];
            // The nearest row last: it has just been computed.
            for (block, &j) in self.beyond[at.clone()].iter().zip(&pattern.columns[at]).rev() {
                let part = times(block, &z[j as usize]);
                (0..D).for_each(|k| y[k] -= part[k]);
            }
            z[i] = y;
        }
    }
}

/// The inverse by a Cholesky factor; `None` if the block is not positive definite.
#[inline(always)]
fn inverse<const D: usize>(a: &Block<D>) -> Option<Block<D>> {
    let (mut l, mut inverse) = ([[0.0; D]; D], [[0.0; D]; D]);
    for j in 0..D {
        let pivot = a[j][j] - (0..j).map(|k| l[j][k] * l[j][k]).sum::<f64>();
        // What remains of it is a rounding error.
        if !(pivot > 1e-14 * a[j][j] && pivot.is_finite()) {
            return None;
        }
        l[j][j] = pivot.sqrt();
        for i in j + 1..D {
            l[i][j] = (a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>()) / l[j][j];
        }
    }
    for j in 0..D {
        inverse[j][j] = 1.0 / l[j][j];
        for i in j + 1..D {
            inverse[i][j] = -(j..i).map(|k| l[i][k] * inverse[k][j]).sum::<f64>() / l[i][i];
        }
    }
    Some(from_fn(|i| from_fn(|j| (i.max(j)..D).map(|k| inverse[k][i] * inverse[k][j]).sum())))
}

#[inline(always)]
fn product<const D: usize>(a: &Block<D>, b: &Block<D>) -> Block<D> {
    from_fn(|i| turned_times(b, &a[i]))
}

/// `c ← c − aᵀ b`.
#[inline(always)]
fn subtract<const D: usize>(c: &mut Block<D>, a: &Block<D>, b: &Block<D>) {
    for i in 0..D {
        for k in 0..D {
            for j in 0..D {
                c[i][j] -= a[k][i] * b[k][j];
            }
        }
    }
}
