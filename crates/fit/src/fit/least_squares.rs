//! The normal equations `M k = b` of `min_k ‖R − Σ_s k_s g_s g_sᵀ‖` in a Frobenius norm, from the node positions alone.
//!
//! A length spring has `g = (−n at i, n at j)` and `n nᵀ = d dᵀ/‖d‖²`, d = x_j − x_i: no square root is needed, and
//! neither R nor any `g gᵀ` is formed. Each weight gives a spring a motion `y_s`, whose gradient at a point is `n wᵀ`:
//!
//! - all entries: `y_s = g_s`, `w = ∇N_j − ∇N_i`, `M_st = (g_s·g_t)²`, `b_s = g_sᵀ R g_s`; Natsupakpong and Çavuşoğlu
//!   (2010), (23);
//! - blocks of different nodes: `b_s = −2 nᵀ R_ij n`, and `M_st = 2` only if s and t join the same nodes;
//! - modal: `y_s = h² g_s + (1 − h²) P g_s`, `M_st = (g_s·y_t)²`, `b_s = y_sᵀ R y_s`, with P the projection on the
//!   linear motions `u_a = A r_a`, r_a the position of node a relative to the mean of the nodes, and A without a
//!   rotation. With `S = Σ r_a r_aᵀ`, `(P g)_a = (r_aᵀ S⁻¹ d) n`, so that `w = h² (∇N_j − ∇N_i) + (1 − h²) S⁻¹ d`.
//!
//! Theory: pages *Least squares* and *Modal weights* of the book.

use super::edge_cell::{EdgeCell, Gradients, scales};
use super::input::check_length;
use super::linear_motions::{LinearMotions, from_mean};
use super::normal::Normal;
use super::weight::{ClosedWeight, Weight};
use crate::element::Tabulation;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{Hooke, Moduli};
use crate::scalar::{Scalar, difference, dot, of_dimension, plus_multiple};
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// The constants of one element in any kind of number, such as `f32` or exact rationals; nodes at `x`,
/// `[nodes × dimension]`.
///
/// # Errors
/// The springs and the table differ in their numbers of nodes or dimensions; `x` has another length; the weight is
/// `relative` or springs measure functions, both of which require roots; the Jacobian is not positive everywhere; or
/// the springs are linearly dependent.
pub fn constants_in<T: Scalar>(
    weight: Weight,
    springs: &Springs,
    table: &Tabulation<T::Constant>,
    x: &[T],
    moduli: &Moduli<T::Constant>,
) -> Result<Vec<T>> {
    // What requires roots is refused before anything is computed: rational numbers have none.
    let weight = weight.closed(springs.need_matrix())?;
    if (table.nodes, table.dimension) != (springs.nodes(), springs.dimension()) {
        let expected = format!("a table of {} nodes in {} dimensions", springs.nodes(), springs.dimension());
        return Err(Error::expected("table", expected, format!("{} in {}", table.nodes, table.dimension)));
    }
    check_length("x", x.len(), springs.nodes() * springs.dimension())?;
    let none = |problem: &str| Error::new(problem).of_kind(ErrorKind::Infeasible);
    let mut geometry = Geometry::like(&x[0], table);
    if !geometry.update(table, x) {
        return Err(none("the Jacobian is not positive everywhere"));
    }
    let mut normal = Normal::default();
    normal_equations(weight, springs, x, &geometry, &Hooke::Isotropic(moduli.of_kind(&x[0])), &mut normal);
    // NaN is not equal to itself plus one.
    let is_finite = |k: &T| (k.one() + &(k.clone() - k)).exceeds(&k.zero());
    if !(normal.solve_regular() && normal.rhs.iter().all(is_finite)) {
        return Err(none("the springs are linearly dependent"));
    }
    Ok(normal.rhs)
}

/// Fills in the lower triangle of `M`, and `b`, for the element with nodes at `x`, `[nodes × dimension]`.
pub fn normal_equations<T: Scalar>(
    weight: ClosedWeight,
    springs: &Springs,
    x: &[T],
    geometry: &Geometry<T>,
    hooke: &Hooke<T>,
    normal: &mut Normal<T>,
) {
    let n = springs.nodes();
    x[0].vectorize(
        #[inline(always)]
        || of_dimension!(springs.dimension(), |D| equations::<T, D>(n, weight, springs, x, geometry, hooke, normal)),
    );
}

/// [`normal_equations`] in D dimensions; a number of nodes that the compiler knows lets it unroll the loops.
#[inline(always)]
pub(super) fn equations<T: Scalar, const D: usize>(
    n: usize,
    weight: ClosedWeight,
    springs: &Springs,
    x: &[T],
    geometry: &Geometry<T>,
    hooke: &Hooke<T>,
    normal: &mut Normal<T>,
) {
    let x = &x.as_chunks::<D>().0[..n];
    let zero = x[0][0].zero();
    let (m, lengths) = (springs.len(), springs.pairs().len());
    let pairs = springs.pairs();
    let Normal { gram, rhs, edges, inverse_squares: q, images, positions, .. } = normal;
    gram.resize(m * m, zero.clone());
    images.resize(lengths * D, zero.clone());
    let images = images.as_chunks_mut::<D>().0;
    let cell = EdgeCell::new(springs, x, geometry, hooke, edges, q, rhs);
    let two = zero.one() + &zero.one();
    match weight {
        ClosedWeight::None => {
            cell.plain_energies(rhs);
            clear(gram, m, &zero);
            // Springs without a common node have `M_st = 0`: their pairs, which are most, are not visited.
            for &(s, t) in springs.touching() {
                gram[t * m + s] = cell.cosine_squared(s, t);
            }
            // `(g·g)² = 4`, because g has a unit vector at each of its two ends.
            for s in 0..lengths {
                gram[s * m + s] = two.clone().squared();
            }
        }
        ClosedWeight::OffDiagonal => {
            cell.energies(
                rhs,
                #[inline(always)]
                |s, grad: &[[T; D]]| {
                    let [i, j] = pairs[s];
                    Gradients::Two(grad[i].clone(), grad[j].clone())
                },
            );
            for b in rhs.iter_mut() {
                *b = zero.clone() - &(two.clone() * b);
            }
            clear(gram, m, &zero);
            for &(s, t) in springs.parallel() {
                gram[t * m + s] = two.clone();
            }
            for s in 0..lengths {
                gram[s * m + s] = two.clone();
            }
        }
        ClosedWeight::Modal(higher) => {
            let (h2, rest) = scales(&zero, higher);
            positions.resize(n * D, zero.clone());
            let q = positions.as_chunks_mut::<D>().0;
            from_mean(x, q);
            let linear = LinearMotions::of(q);
            let q = &*q;
            // (1 − h²) S⁻¹ d_s = (1 − h²) U⁻¹ D⁻¹ (q_j − q_i)
            for (image, &[i, j]) in images.iter_mut().zip(pairs) {
                *image = linear.in_space(&linear.weighted(&rest, &difference(&q[j], &q[i])));
            }
            let of_springs = &*images;
            cell.energies(
                rhs,
                #[inline(always)]
                |s, grad: &[[T; D]]| {
                    let plain = difference(&grad[pairs[s][1]], &grad[pairs[s][0]]);
                    Gradients::Same(plus_multiple(&of_springs[s], &h2, &plain))
                },
            );
            // g_s·y_t = (h² c_st + (1 − h²) d_sᵀ S⁻¹ d_t) n_s·n_t, with d_sᵀ S⁻¹ d_t in the basis where S is diagonal,
            // and c_st the number of shared ends of equal sign less those of unequal sign.
            for t in 0..lengths {
                images[t] = difference(&q[pairs[t][1]], &q[pairs[t][0]]);
                let along = linear.weighted(&rest, &images[t]);
                // P couples springs that share no node: no pair is left out here.
                for s in 0..=t {
                    let ([a, b], [c, d]) = (pairs[s], pairs[t]);
                    // A spring between one node and itself does not exist, so that the number is from −2 to 2.
                    let ends = i8::from(a == c) + i8::from(b == d) - i8::from(a == d) - i8::from(b == c);
                    let mut factor = dot(&images[s], &along);
                    if ends != 0 {
                        factor = factor.plus_product(&h2, &zero.constant(&T::exact(ends.into())));
                    }
                    gram[t * m + s] = factor.squared() * &cell.cosine_squared(s, t);
                }
            }
        }
    }
    if springs.content().is_some() {
        cell.content(weight, &mut gram[(m - 1) * m..m * m], rhs);
    }
}

/// Sets the lower triangle to zero.
#[inline(always)]
fn clear<T: Scalar>(gram: &mut [T], m: usize, zero: &T) {
    for s in 0..m {
        for entry in &mut gram[s * m..=s * m + s] {
            *entry = zero.clone();
        }
    }
}
