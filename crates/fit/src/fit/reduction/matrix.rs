//! A stiffness that is given as a matrix, on its deformations.

use super::super::weight::MotionWeight;
use super::Reduced;
use crate::scalar::{Real, of_dimension};
use crate::springs::Springs;

impl<T: Real> Reduced<T> {
    /// Fills in a matrix `r`, `[nodes·dimension × nodes·dimension]`, in place of that of an element, with springs on lengths alone.
    pub fn set_matrix(&mut self, weight: MotionWeight, springs: &Springs, x: &[T], r: &[T]) {
        of_dimension!(springs.dimension(), |D| self.set_matrix_in::<D>(weight, springs, x, r))
    }

    fn set_matrix_in<const D: usize>(&mut self, weight: MotionWeight, springs: &Springs, x: &[T], r: &[T]) {
        let n = springs.nodes();
        let x = &x.as_chunks::<D>().0[..n];
        self.set_mix(weight, x);
        self.mix_matrix::<D>(n, r);
        self.set_lengths(springs, x);
        // The rows of `mix` add up to zero, which took out the translations; the rotations are left.
        self.take_out_rotations::<D>(n);
        if weight.divides_by_stiffness() {
            self.divide_by_stiffness();
        }
        self.normalise();
    }

    /// `C R Cᵀ` with the map C from nodes to differences, lower triangle.
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
