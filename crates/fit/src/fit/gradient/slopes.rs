//! The slopes of a number L in what a cell is made of, and how those in its geometry become those in its nodes.
//!
//! Theory: page *Gradients of spring constants* of the book.

use crate::scalar::{Scalar, dot};
use crate::stiffness::Geometry;

/// `∂L/∂(·)` of one cell, or of one per lane.
pub struct Slopes<T> {
    /// The slopes in the gradients of the shape functions, `[points × nodes × dimension]`.
    pub gradients: Vec<T>,
    /// The slopes in the volumes of the quadrature points.
    pub volumes: Vec<T>,
    /// The slopes in the volumes for the term λ (div u)².
    pub volumetric: Vec<T>,
    /// The slopes in λ and μ.
    pub moduli: [T; 2],
    /// The slopes in the positions of the nodes, `[nodes × dimension]`.
    pub x: Vec<T>,
}

impl<T: Scalar> Slopes<T> {
    /// Memory for cells of this geometry.
    pub fn like(zero: &T, geometry: &Geometry<T>) -> Slopes<T> {
        let (points, size) = (geometry.volumes.len(), geometry.nodes * geometry.dimension);
        Slopes {
            gradients: vec![zero.clone(); points * size],
            volumes: vec![zero.clone(); points],
            volumetric: vec![zero.clone(); points],
            moduli: [zero.clone(), zero.clone()],
            x: vec![zero.clone(); size],
        }
    }

    /// Sets all of them to zero.
    #[inline(always)]
    pub fn clear(&mut self, zero: &T) {
        for all in [&mut self.gradients, &mut self.volumes, &mut self.volumetric, &mut self.x] {
            for slope in all.iter_mut() {
                *slope = zero.clone();
            }
        }
        self.moduli = [zero.clone(), zero.clone()];
    }

    /// Adds the slopes in the content `Σ_q w_q |J_q|`.
    #[inline(always)]
    pub fn add_content(&mut self, slope: &T) {
        for volume in &mut self.volumes {
            *volume = volume.clone() + slope;
        }
    }

    /// Adds to the slopes in the nodes those that come through the geometry. With G the gradients and v the volumes,
    ///
    /// `∂G_bk/∂x_am = −G_bm G_ak`, `∂v/∂x_am = v G_am`
    #[inline(always)]
    pub fn through_geometry<const D: usize>(&mut self, n: usize, geometry: &Geometry<T>) {
        let x = &mut self.x.as_chunks_mut::<D>().0[..n];
        let all = self.gradients.chunks_exact(n * D).zip(self.volumes.iter().zip(&self.volumetric));
        for ((grad, v, w), (slopes, (of_volume, of_volumetric))) in geometry.each_point().zip(all) {
            let (grad, slopes) = (&grad.as_chunks::<D>().0[..n], &slopes.as_chunks::<D>().0[..n]);
            let volume = (of_volume.clone() * v).plus_product(of_volumetric, w);
            // P_mk = Σ_b G_bm Ḡ_bk
            let mut p: [[T; D]; D] = v.zero().repeated_rows();
            for b in 0..n {
                for m in 0..D {
                    for k in 0..D {
                        p[m][k] = p[m][k].clone().plus_product(&grad[b][m], &slopes[b][k]);
                    }
                }
            }
            for a in 0..n {
                for m in 0..D {
                    let own = x[a][m].clone().plus_product(&volume, &grad[a][m]);
                    x[a][m] = own - &dot(&p[m], &grad[a]);
                }
            }
        }
    }
}

/// Adds `factor` times a vector.
#[inline(always)]
pub fn add<T: Scalar, const D: usize>(to: &mut [T; D], factor: &T, of: &[T; D]) {
    for k in 0..D {
        to[k] = to[k].clone().plus_product(factor, &of[k]);
    }
}
