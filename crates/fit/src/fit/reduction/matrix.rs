//! A stiffness that is given as a matrix, on the differences of nodes.

use super::Reduced;
use crate::scalar::Real;

impl<T: Real> Reduced<T> {
    /// `C R Cᵀ` with the map C from nodes to differences, lower triangle.
    #[inline(always)]
    pub(super) fn mix_matrix<const D: usize>(&mut self, n: usize, r: &[T]) {
        let (full, size) = ((n - 1) * D, n * D);
        let zero = self.size.zero();
        // `C R` and then `(C R) Cᵀ`: two products of matrices cost less than a sum over four indices.
        let mut half = vec![zero.clone(); full * size];
        for (i, row) in self.mix.chunks_exact(n).enumerate() {
            for k in 0..D {
                let sums = &mut half[(i * D + k) * size..][..size];
                for (a, c) in row.iter().enumerate() {
                    for (sum, entry) in sums.iter_mut().zip(&r[(a * D + k) * size..]) {
                        *sum = sum.clone().plus_product(c, entry);
                    }
                }
            }
        }
        for at in 0..full {
            for (j, row) in self.mix.chunks_exact(n).enumerate() {
                for l in 0..D {
                    let own = &half[at * size..(at + 1) * size];
                    let sum =
                        row.iter().enumerate().fold(zero.clone(), |sum, (b, c)| sum.plus_product(c, &own[b * D + l]));
                    self.stiffness[at * full + j * D + l] = sum;
                }
            }
        }
    }
}
