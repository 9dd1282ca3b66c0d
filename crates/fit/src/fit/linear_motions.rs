//! The linear motions `u_a = A r_a` of an element, with r_a the node positions relative to their mean. Modal weights
//! distinguish them from all other deformations.
//!
//! Theory: page *Modal weights* of the book.

use crate::scalar::{Scalar, plus_multiple, zeros};

/// The factorisation `R = Q U` of the matrix R with rows r_a, with Q of orthogonal columns and U unit upper triangular:
/// `S⁻¹ = (RᵀR)⁻¹ = U⁻¹ D⁻¹ U⁻ᵀ`, `D = QᵀQ`, and the projection on the linear motions is `Q D⁻¹ Qᵀ`.
///
/// Computed by the modified Gram–Schmidt method. Its error grows with the condition of R, where that of S would grow
/// with its square; and it needs no roots, which rational numbers do not have.
pub struct LinearMotions<T, const D: usize> {
    /// `U⁻¹`, upper triangular: row k, column l.
    pub back: [[T; D]; D],
    /// `D⁻¹`.
    pub inverse_squares: [T; D],
}

impl<T: Scalar, const D: usize> LinearMotions<T, D> {
    /// Replaces the rows of R in `q` by those of Q.
    #[inline(always)]
    pub fn of(q: &mut [[T; D]]) -> LinearMotions<T, D> {
        let zero = q[0][0].zero();
        let mut back: [[T; D]; D] = zero.repeated_rows();
        let mut inverse_squares: [T; D] = zeros(&zero);
        for l in 0..D {
            back[l][l] = zero.one();
            for m in 0..l {
                let mut along = zero.clone();
                for row in q.iter() {
                    along = along.plus_product(&row[m], &row[l]);
                }
                let share = along * &inverse_squares[m];
                for row in q.iter_mut() {
                    row[l] = row[l].clone().minus_product(&share, &row[m]);
                }
                // `U⁻¹` is built column by column with the same shares: it needs no substitution afterwards.
                for k in 0..=m {
                    back[k][l] = back[k][l].clone().minus_product(&share, &back[k][m]);
                }
            }
            let mut square = zero.clone();
            for row in q.iter() {
                square = square.plus_product(&row[l], &row[l]);
            }
            inverse_squares[l] = zero.one() / &square;
        }
        LinearMotions { back, inverse_squares }
    }

    /// `factor D⁻¹ v`.
    #[inline(always)]
    pub fn weighted(&self, factor: &T, v: &[T; D]) -> [T; D] {
        let mut weighted = v.clone();
        for l in 0..D {
            weighted[l] = weighted[l].clone() * &self.inverse_squares[l] * factor;
        }
        weighted
    }

    /// `U⁻¹ v`.
    #[inline(always)]
    pub fn in_space(&self, v: &[T; D]) -> [T; D] {
        let mut image = v.clone();
        for k in 0..D {
            for l in k + 1..D {
                image[k] = image[k].clone().plus_product(&self.back[k][l], &v[l]);
            }
        }
        image
    }

    /// `factor S⁻¹`.
    #[inline(always)]
    pub fn inverse_spread(&self, factor: &T) -> [[T; D]; D] {
        let zero = factor.zero();
        let mut inverse: [[T; D]; D] = zero.repeated_rows();
        for l in 0..D {
            let scale = self.inverse_squares[l].clone() * factor;
            for i in 0..=l {
                for j in 0..=l {
                    let product = self.back[i][l].clone() * &scale;
                    inverse[i][j] = inverse[i][j].clone().plus_product(&product, &self.back[j][l]);
                }
            }
        }
        inverse
    }
}

/// Writes the rows r_a of nodes at `x` into `q`.
#[inline(always)]
pub fn from_mean<T: Scalar, const D: usize>(x: &[[T; D]], q: &mut [[T; D]]) {
    let zero = x[0][0].zero();
    // The sign is in the share, so that subtraction is one more sum of products.
    let share = zero.constant(&T::exact(-1.0)) / &zero.constant(&T::exact(x.len() as f64));
    let mut less: [T; D] = zeros(&zero);
    for x in x {
        less = plus_multiple(&less, &share, x);
    }
    for (q, x) in q.iter_mut().zip(x) {
        for k in 0..D {
            q[k] = x[k].clone() + &less[k];
        }
    }
}
