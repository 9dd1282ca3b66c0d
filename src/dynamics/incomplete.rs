//! An incomplete Cholesky factor of blocks.

use super::blocks::{Block, Pattern, times, turned_times};

/// Shares of the diagonal that are added to it until no pivot is lost (Manteuffel 1980).
const SHIFTS: [f64; 8] = [0.0, 0.01, 0.03, 0.1, 0.3, 1.0, 10.0, 100.0];

/// `A ≈ Uᵀ U`, U with the pattern of A's upper triangle (Meijerink and van der Vorst 1977).
#[derive(Debug)]
pub(super) struct Incomplete<const D: usize> {
    /// `U_ii⁻ᵀ`, lower triangular.
    inverses: Vec<Block<D>>,
    /// Beyond the diagonal.
    beyond: Vec<Block<D>>,
    pivots: Vec<Block<D>>,
    /// `[p, q, t]`: block t loses `U_pᵀ U_q`, of one row after the other.
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
        Incomplete { inverses: zeros(rows), beyond: zeros(pattern.columns.len()), pivots: zeros(rows), updates, starts }
    }

    /// Of A, blocks of the diagonal first; false where it has none even with a hundred times its diagonal: A is not positive definite.
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
            let Some(inverse) = inverse_factor(&self.pivots[i]) else { return false };
            self.inverses[i] = inverse;
            for p in pattern.starts[i]..pattern.starts[i + 1] {
                self.beyond[p] = product(&inverse, &self.beyond[p]);
                let block = self.beyond[p];
                subtract(&mut self.pivots[pattern.columns[p] as usize], &block, &block);
            }
            for &[p, q, t] in &self.updates[self.starts[i]..self.starts[i + 1]] {
                let (a, b) = (self.beyond[p as usize], self.beyond[q as usize]);
                subtract(&mut self.beyond[t as usize], &a, &b);
            }
        }
        true
    }

    /// `z ← U⁻¹ U⁻ᵀ z`.
    pub fn solve(&self, pattern: &Pattern, z: &mut [[f64; D]]) {
        for i in 0..pattern.rows() {
            let y = times(&self.inverses[i], &z[i]);
            z[i] = y;
            let at = pattern.starts[i]..pattern.starts[i + 1];
            for (block, &j) in self.beyond[at.clone()].iter().zip(&pattern.columns[at]) {
                let part = turned_times(block, &y);
                (0..D).for_each(|k| z[j as usize][k] -= part[k]);
            }
        }
        for i in (0..pattern.rows()).rev() {
            let mut y = z[i];
            let at = pattern.starts[i]..pattern.starts[i + 1];
            for (block, &j) in self.beyond[at.clone()].iter().zip(&pattern.columns[at]) {
                let part = times(block, &z[j as usize]);
                (0..D).for_each(|k| y[k] -= part[k]);
            }
            z[i] = turned_times(&self.inverses[i], &y);
        }
    }
}

/// `L⁻¹` of `L Lᵀ`; `None` where that is not positive definite.
#[inline(always)]
fn inverse_factor<const D: usize>(a: &Block<D>) -> Option<Block<D>> {
    let (mut l, mut inverse) = ([[0.0; D]; D], [[0.0; D]; D]);
    for j in 0..D {
        let pivot = a[j][j] - (0..j).map(|k| l[j][k] * l[j][k]).sum::<f64>();
        // What is left of it is rounding.
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
    Some(inverse)
}

#[inline(always)]
fn product<const D: usize>(a: &Block<D>, b: &Block<D>) -> Block<D> {
    std::array::from_fn(|i| turned_times(b, &a[i]))
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
