//! Functions beside those of the nodes: their gradients, and the stiffness in which they follow the nodes.
//!
//! With the amplitudes a of the modes the cell has the energy `½ uᵀ R_uu u + aᵀ R_au u + ½ aᵀ R_aa a`. It is least at `a = −R_aa⁻¹ R_au u`,
//! which leaves `R = R_uu − R_ua R_aa⁻¹ R_au`. Theory: page *Stiffness and the reduced space* of the book.

use super::{Geometry, add_stiffness, jacobian};
use crate::element::Tabulation;
use crate::material::Hooke;
use crate::scalar::{Scalar, adjugate, multiple, of_dimension, vectorized};

impl<T: Scalar> Geometry<T> {
    /// Whether the element has functions that are condensed.
    pub fn is_condensed(&self) -> bool {
        self.mode_count > 0
    }

    /// `R = ∫ Bᵀ D B dV`, `[nodes·dimension × nodes·dimension]`, in any kind of number; functions beside those of the nodes are condensed.
    pub fn entries(&self, hooke: &Hooke<T>) -> Vec<T> {
        vectorized!(self.volumes[0], of_dimension!(self.dimension, |D| self.entries_in::<D>(hooke)))
    }

    #[inline(always)]
    fn entries_in<const D: usize>(&self, hooke: &Hooke<T>) -> Vec<T> {
        let size = (self.nodes + self.mode_count) * D;
        let mut r = vec![self.volumes[0].zero(); size * size];
        let mut all = Vec::new();
        for (q, (grad, v, w)) in self.each_point().enumerate() {
            let own = self.mode_count * D;
            all.clear();
            all.extend_from_slice(grad);
            all.extend_from_slice(&self.modes[q * own..(q + 1) * own]);
            add_stiffness(&mut r, all.as_chunks::<D>().0, hooke, v, w);
        }
        eliminated(r, size, self.nodes * D)
    }

    /// The gradients of the modes with nodes at `x`: `J⁻ᵀ ∂M/∂ξ` of bubbles; of others `(j₀/j) J₀⁻ᵀ ∂M/∂ξ`, with J₀ and its determinant j₀
    /// at the centre of the cell, whose integral vanishes with that of `∂M/∂ξ` on every shape (Taylor, Beresford and Wilson 1976).
    #[inline(always)]
    pub(super) fn update_modes<const D: usize>(&mut self, table: &Tabulation<T::Constant>, x: &[T]) {
        let Some(modes) = &table.modes else { return };
        let (x, n) = (x.as_chunks::<D>().0, self.nodes);
        let (middle, middle_determinant) = adjugate(&jacobian(x, &modes.centre.as_chunks::<D>().0[..n]));
        let middle = multiple(&(middle_determinant.one() / &middle_determinant), &middle);
        let count = modes.count();
        let reference = table.gradients.chunks_exact(n * D).zip(modes.gradients.chunks_exact(count * D));
        for ((dn, dm), own) in reference.zip(self.modes.chunks_exact_mut(count * D)) {
            let (here, determinant) = adjugate(&jacobian(x, dn.as_chunks::<D>().0));
            let inverse = determinant.one() / &determinant;
            let here = multiple(&inverse, &here);
            let there = multiple(&(middle_determinant.clone() * &inverse), &middle);
            let each = own.as_chunks_mut::<D>().0.iter_mut().zip(dm.as_chunks::<D>().0);
            for ((gradient, dm), is_bubble) in each.zip(&modes.bubbles) {
                // A bubble vanishes on the sides and needs no correction: its gradient integrates to zero by itself.
                let back = if *is_bubble { &here } else { &there };
                for k in 0..D {
                    gradient[k] = back[0][k].zero();
                    for l in 0..D {
                        gradient[k] = gradient[k].clone().plus_product(&back[l][k], &back[l][k].constant(&dm[l]));
                    }
                }
            }
        }
    }
}

/// Takes the degrees of freedom from `kept` on out of a symmetric matrix, `[size × size]`, of which the lower triangle is read; writes both
/// triangles of `[kept × kept]`.
#[inline(always)]
fn eliminated<T: Scalar>(mut matrix: Vec<T>, size: usize, kept: usize) -> Vec<T> {
    // Elimination from the last row up leaves the kept rows in place, and needs neither a factor nor a root.
    for last in (kept..size).rev() {
        let (before, row) = matrix.split_at_mut(last * size);
        // The reader of element files proves the modes to be independent, so that `R_aa` is positive definite and no pivot is zero.
        let pivot = row[last].clone();
        for i in 0..last {
            let factor = row[i].clone() / &pivot;
            for j in 0..=i {
                before[i * size + j] = before[i * size + j].clone().minus_product(&factor, &row[j]);
            }
        }
    }
    let entry = |e: usize| (e / kept).max(e % kept) * size + (e / kept).min(e % kept);
    (0..kept * kept).map(|e| matrix[entry(e)].clone()).collect()
}
