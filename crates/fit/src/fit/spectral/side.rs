//! One of the two matrices `tI ± E` of the spectral problem.

use crate::fit::dense::{factorize, invert, row_products};
use crate::scalar::Real;

/// One of the two matrices that stay positive definite, with its inverse.
#[derive(Debug, Clone)]
pub struct ShiftedMatrix<T> {
    pub matrix: Vec<T>,
    pub pivots: Vec<T>,
    pub inverse: Vec<T>,
    /// `A⁻¹ h_s`, `[springs × order]`.
    pub images: Vec<T>,
    /// `h_sᵀ A⁻¹ h_t`, lower triangle.
    pub products: Vec<T>,
}

impl<T: Real> ShiftedMatrix<T> {
    pub fn new(zero: &T, p: usize, m: usize) -> ShiftedMatrix<T> {
        let room = |size: usize| vec![zero.clone(); size];
        ShiftedMatrix {
            matrix: room(p * p),
            pivots: room(p),
            inverse: room(p * p),
            images: room(m * p),
            products: room(m * m),
        }
    }

    /// Factorises `tI ± E` and returns the least relative pivot.
    #[inline(always)]
    pub fn set(&mut self, e: &[T], p: usize, t: &T, sign: f64) -> T {
        let sign = t.constant(&sign);
        for i in 0..p {
            for j in 0..=i {
                self.matrix[i * p + j] = e[i * p + j].clone() * &sign;
            }
            self.matrix[i * p + i] = self.matrix[i * p + i].clone() + t;
        }
        // No floor: a pivot that is not positive must show that t is too small.
        factorize(&mut self.matrix, p, 0.0, &mut self.pivots)
    }

    #[inline(always)]
    pub fn invert(&mut self, h: &[T], p: usize, room: &mut [T]) {
        invert(&self.matrix, p, &self.pivots, room, &mut self.inverse);
        row_products(h, &self.inverse, p, false, &mut self.images);
        row_products(h, &self.images, p, true, &mut self.products);
    }

    /// Writes `X = μ (A⁻¹ − A⁻¹ ΔA A⁻¹)`, lower triangle, into `matrix`; ΔA has both triangles.
    #[inline(always)]
    pub fn dual(&mut self, change: &[T], mu: &T, p: usize, room: &mut [T]) {
        let room = &mut room[..p * p];
        row_products(&self.inverse, change, p, false, room);
        row_products(room, &self.inverse, p, true, &mut self.matrix);
        for (x, inverse) in self.matrix.iter_mut().zip(&self.inverse) {
            *x = (inverse.clone() - &*x) * mu;
        }
    }
}
