//! The linear motions of a cell, which modal weights distinguish, and the slopes that come through them.
//!
//! Theory: page *Modal weights* of the book.

use super::slopes::{Slopes, add};
use crate::fit::linear_motions::{LinearMotions, from_mean};
use crate::scalar::Real;

/// The linear motions of a cell under a modal weight: `S⁻¹` and `B = (1 − h²) S⁻¹`, and the slope in B.
pub struct Modal<T, const D: usize> {
    pub h2: T,
    rest: T,
    inverse: [[T; D]; D],
    pub b: [[T; D]; D],
    pub of_b: [[T; D]; D],
}

impl<T: Real, const D: usize> Modal<T, D> {
    /// The motions of nodes at x, with `h²` and `1 − h²`.
    #[inline(always)]
    pub fn of(x: &[[T; D]], h2: T, rest: T) -> Modal<T, D> {
        let mut q = x.to_vec();
        from_mean(x, &mut q);
        let motions = LinearMotions::of(&mut q);
        let (inverse, b) = (motions.inverse_spread(&rest.one()), motions.inverse_spread(&rest));
        let of_b = rest.zero().repeated_rows();
        Modal { h2, rest, inverse, b, of_b }
    }

    /// `∂L/∂S = −(1 − h²) S⁻¹ (∂L/∂B) S⁻¹`, `∂L/∂r_a = (∂L/∂S + its transpose) r_a`; the mean of all nodes has no slope, because `Σ r_a = 0`.
    #[inline(always)]
    pub fn add_slopes(&self, x: &[[T; D]], slopes: &mut Slopes<T>) {
        let zero = self.rest.zero();
        let mut left: [[T; D]; D] = zero.repeated_rows();
        for k in 0..D {
            for m in 0..D {
                let share = (self.inverse[k][m].clone() * &self.rest).negated();
                add(&mut left[k], &share, &self.of_b[m]);
            }
        }
        let mut of_spread: [[T; D]; D] = zero.repeated_rows();
        for k in 0..D {
            for m in 0..D {
                add(&mut of_spread[k], &left[k][m], &self.inverse[m]);
            }
        }
        let mut r = x.to_vec();
        from_mean(x, &mut r);
        let of_x = &mut slopes.x.as_chunks_mut::<D>().0[..x.len()];
        for (of_x, r) in of_x.iter_mut().zip(&r) {
            for k in 0..D {
                for l in 0..D {
                    let both = of_spread[k][l].clone() + &of_spread[l][k];
                    of_x[k] = of_x[k].clone().plus_product(&both, &r[l]);
                }
            }
        }
    }
}
