//! Normal equations `M k = b` of `min_k ‖R − Σ_s k_s g_s g_sᵀ‖` in a Frobenius norm, from the node positions alone.
//!
//! A length spring has `g = (−n at i, n at j)` and `n nᵀ = d dᵀ/‖d‖²`, d = x_j − x_i: nothing needs a square root, and
//! neither R nor any `g gᵀ` is formed. Each weight gives a spring a motion `y_s`, whose gradient at a point is `n wᵀ`:
//! - all entries: `y_s = g_s`, `w = ∇N_j − ∇N_i`, `M_st = (g_s·g_t)²`, `b_s = g_sᵀ R g_s`; Natsupakpong and Çavuşoğlu
//!   (2010), (23);
//! - blocks of different nodes: `b_s = −2 nᵀ R_ij n`, and `M_st = 2` only where s and t join the same nodes;
//! - modal: `y_s = h² g_s + (1 − h²) P g_s`, `M_st = (g_s·y_t)²`, `b_s = y_sᵀ R y_s`, with P the projection on the linear
//!   motions `u_a = A r_a`, r_a = x_a less the mean of the nodes, in which g has no rotation. With `S = Σ r_a r_aᵀ`,
//!   `(P g)_a = (r_aᵀ S⁻¹ d) n`, so that `w = h² (∇N_j − ∇N_i) + (1 − h²) S⁻¹ d`.

use super::Weight;
use super::normal::Normal;
use crate::element::Tabulation;
use crate::material::Moduli;
use crate::scalar::{Scalar, adjugate, difference, dot, multiple, plus_multiple, product, zeros};
use crate::springs::Springs;
use crate::stiffness::Geometry;
use std::array::from_fn;

/// The constants of one element in any kind of number, such as `f32` or exact rationals; nodes at `x`,
/// `[nodes × dimension]`. None if the Jacobian is not positive everywhere or the springs are linearly dependent, and for the
/// weight `relative`, which needs roots.
pub fn constants_in<T: Scalar>(
    weight: Weight,
    springs: &Springs,
    table: &Tabulation<T::Constant>,
    x: &[T],
    moduli: &Moduli<T::Constant>,
) -> Option<Vec<T>> {
    if weight == Weight::Relative {
        return None;
    }
    let mut geometry = Geometry::of_kind(x.first()?, table);
    let mut normal = Normal::default();
    if !geometry.update(table, x) {
        return None;
    }
    normal_equations(weight, springs, x, &geometry, moduli, &mut normal);
    normal.solve_regular().then_some(normal.rhs)
}

/// Fills in the lower triangle of `M`, and `b`, of the element with nodes at `x`, `[nodes × dimension]`.
#[inline(always)]
pub fn normal_equations<T: Scalar>(
    weight: Weight,
    springs: &Springs,
    x: &[T],
    geometry: &Geometry<T>,
    moduli: &Moduli<T::Constant>,
    normal: &mut Normal<T>,
) {
    // As in the geometry: small sizes known at compile time.
    match (springs.dimension, springs.nodes) {
        (2, 3) => equations::<T, 2>(3, weight, springs, x, geometry, moduli, normal),
        (2, 4) => equations::<T, 2>(4, weight, springs, x, geometry, moduli, normal),
        (3, 4) => equations::<T, 3>(4, weight, springs, x, geometry, moduli, normal),
        (3, 8) => equations::<T, 3>(8, weight, springs, x, geometry, moduli, normal),
        (2, n) => equations::<T, 2>(n, weight, springs, x, geometry, moduli, normal),
        (_, n) => equations::<T, 3>(n, weight, springs, x, geometry, moduli, normal),
    }
}

#[inline(always)]
fn equations<T: Scalar, const D: usize>(
    n: usize,
    weight: Weight,
    springs: &Springs,
    x: &[T],
    geometry: &Geometry<T>,
    moduli: &Moduli<T::Constant>,
    normal: &mut Normal<T>,
) {
    let x = &x.as_chunks::<D>().0[..n];
    let zero = x[0][0].zero();
    let (lambda, mu) = (zero.constant(&moduli.lambda), zero.constant(&moduli.mu));
    let (m, lengths) = (springs.len(), springs.pairs.len());
    let pairs = &springs.pairs[..];
    let Normal { gram, rhs, edges, inverse_squares: q, images, .. } = normal;
    rhs.clear();
    rhs.resize(m, zero.clone());
    gram.resize(m * m, zero.clone());
    edges.resize(lengths * D, zero.clone());
    images.resize(lengths * D, zero.clone());
    q.resize(lengths, zero.clone());
    let (edges, images) = (edges.as_chunks_mut::<D>().0, images.as_chunks_mut::<D>().0);
    // d_s = x_j − x_i and 1/‖d_s‖²
    for ((d, q), &[i, j]) in edges.iter_mut().zip(&mut *q).zip(pairs) {
        *d = difference(&x[j], &x[i]);
        *q = zero.one() / &dot(d, d);
    }
    let (edges, q) = (&*edges, &q[..lengths]);
    let cell = Cell { springs, x, edges, q, geometry, lambda, mu };
    let two = zero.one() + &zero.one();
    match weight {
        Weight::None => {
            cell.energies(
                rhs,
                #[inline(always)]
                |s, grad: &[[T; D]]| {
                    let w = difference(&grad[pairs[s][1]], &grad[pairs[s][0]]);
                    (dot(&edges[s], &w).squared(), dot(&w, &w))
                },
            );
            clear(gram, m, &zero);
            for &(s, t) in &springs.touching {
                gram[t * m + s] = cell.cosine_squared(s, t);
            }
            for s in 0..lengths {
                gram[s * m + s] = two.clone().squared();
            }
        }
        Weight::Relative => unreachable!("it needs R itself, which another method forms"),
        Weight::OffDiagonal => {
            cell.energies(
                rhs,
                #[inline(always)]
                |s, grad: &[[T; D]]| {
                    let [i, j] = pairs[s];
                    (dot(&edges[s], &grad[i]) * &dot(&edges[s], &grad[j]), dot(&grad[i], &grad[j]))
                },
            );
            for b in rhs.iter_mut() {
                *b = zero.clone() - &(two.clone() * b);
            }
            clear(gram, m, &zero);
            for &(s, t) in &springs.parallel {
                gram[t * m + s] = two.clone();
            }
            for s in 0..lengths {
                gram[s * m + s] = two.clone();
            }
        }
        Weight::Modal { higher } => {
            let (h2, rest) = scales(&zero, higher);
            let inverse = multiple(&rest, &inverse_spread(x));
            // (1 − h²) S⁻¹ d_s
            for (image, d) in images.iter_mut().zip(edges) {
                *image = product(&inverse, d);
            }
            let images = &*images;
            cell.energies(
                rhs,
                #[inline(always)]
                |s, grad: &[[T; D]]| {
                    let plain = difference(&grad[pairs[s][1]], &grad[pairs[s][0]]);
                    let w = plus_multiple(&images[s], &h2, &plain);
                    (dot(&edges[s], &w).squared(), dot(&w, &w))
                },
            );
            // g_s·y_t = (h² c_st + (1 − h²) d_sᵀ S⁻¹ d_t) n_s·n_t, c_st the ends of equal sign less those of unequal
            for t in 0..lengths {
                for s in 0..=t {
                    let ([a, b], [c, d]) = (pairs[s], pairs[t]);
                    let ends = i8::from(a == c) + i8::from(b == d) - i8::from(a == d) - i8::from(b == c);
                    let mut factor = dot(&edges[s], &images[t]);
                    if ends != 0 {
                        factor = factor.plus_product(&h2, &zero.constant(&T::exact(ends.into())));
                    }
                    gram[t * m + s] = factor.squared() * &cell.cosine_squared(s, t);
                }
            }
        }
    }
    if springs.content.is_some() {
        cell.content(weight, gram, rhs);
    }
}

/// One element, or one per lane.
struct Cell<'a, T, const D: usize> {
    springs: &'a Springs,
    x: &'a [[T; D]],
    /// `d_s`
    edges: &'a [[T; D]],
    /// `1/‖d_s‖²`
    q: &'a [T],
    geometry: &'a Geometry<T>,
    lambda: T,
    mu: T,
}

impl<T: Scalar, const D: usize> Cell<'_, T, D> {
    /// `(n_s·n_t)²`.
    #[inline(always)]
    fn cosine_squared(&self, s: usize, t: usize) -> T {
        dot(&self.edges[s], &self.edges[t]).squared() * &(self.q[s].clone() * &self.q[t])
    }

    /// Adds the energies `∫ (λ + μ)(n·w)² + μ w·w dV` of motions with the gradient `n wᵀ`; `terms(s, gradients)` gives
    /// `(d·w)²` and `w·w` at a quadrature point.
    #[inline(always)]
    fn energies(&self, rhs: &mut [T], terms: impl Fn(usize, &[[T; D]]) -> (T, T)) {
        let (n, rhs) = (self.x.len(), &mut rhs[..self.q.len()]);
        let sum = self.lambda.clone() + &self.mu;
        for (grad, v) in self.geometry.gradients.chunks_exact(n * D).zip(&self.geometry.volumes) {
            let grad = &grad.as_chunks::<D>().0[..n];
            let (along, across) = (sum.clone() * v, self.mu.clone() * v);
            for (s, b) in rhs.iter_mut().enumerate() {
                let (squared, plain) = terms(s, grad);
                let energy = b.clone().plus_product(&across, &plain);
                *b = energy.plus_product(&(along.clone() * &self.q[s]), &squared);
            }
        }
    }

    /// The last row of `M` and entry of `b`: the spring on the cell's content, whose `g` is `c = ∫ ∇N dV`. With V the
    /// content, `P c = V S⁻¹ r_a`, because `Σ_a r_a ∇N_aᵀ = I`.
    #[inline(always)]
    fn content(&self, weight: Weight, gram: &mut [T], rhs: &mut [T]) {
        let m = self.springs.len();
        let last = m - 1;
        let zero = self.lambda.zero();
        let two = zero.one() + &zero.one();
        let gradient = self.geometry.content_gradient();
        let c = gradient.as_chunks::<D>().0;
        let (mut cc, mut fourth) = (zero.clone(), zero.clone());
        for c in c {
            let size = dot(c, c);
            cc = cc + &size;
            fourth = fourth.plus_product(&size, &size);
        }
        let volume = self.geometry.content();
        // y_a = h² c_a + (1 − h²) V S⁻¹ r_a, ∇y = h² Σ_a c_a ∇N_aᵀ + linear
        let (h2, linear) = match weight {
            Weight::Modal { higher } => {
                let (h2, rest) = scales(&zero, higher);
                (h2, multiple(&(rest * &volume), &inverse_spread(self.x)))
            }
            _ => (zero.one(), from_fn(|_| zeros(&zero))),
        };
        for (s, &[i, j]) in self.springs.pairs.iter().enumerate() {
            let d = &self.edges[s];
            gram[last * m + s] = match weight {
                Weight::OffDiagonal => zero.clone() - &(two.clone() * &self.q[s] * &dot(d, &c[i]) * &dot(d, &c[j])),
                _ => {
                    let along = h2.clone() * &dot(d, &difference(&c[j], &c[i]));
                    (along + &dot(d, &product(&linear, d))).squared() * &self.q[s]
                }
            };
        }
        gram[last * m + last] = match weight {
            Weight::OffDiagonal => cc.squared() - &fourth,
            _ => {
                let mut trace = linear[0][0].clone();
                for k in 1..D {
                    trace = trace + &linear[k][k];
                }
                (h2.clone() * &cc).plus_product(&trace, &volume).squared()
            }
        };
        for (grad, v) in self.geometry.gradients.chunks_exact(c.len() * D).zip(&self.geometry.volumes) {
            let grad = grad.as_chunks::<D>().0;
            let mut h = linear.clone();
            let mut alone = zero.clone();
            for (c, g) in c.iter().zip(grad) {
                let mut outer: [[T; D]; D] = from_fn(|_| zeros(&zero));
                for k in 0..D {
                    for l in 0..D {
                        outer[k][l] = c[k].clone() * &g[l];
                        h[k][l] = h[k][l].clone().plus_product(&h2, &outer[k][l]);
                    }
                }
                if weight == Weight::OffDiagonal {
                    alone = alone + &density(&outer, &self.lambda, &self.mu);
                }
            }
            rhs[last] = rhs[last].clone().plus_product(v, &(density(&h, &self.lambda, &self.mu) - &alone));
        }
    }
}

/// Twice the energy density `λ (tr H)² + μ (H : H + H : Hᵀ)` of a displacement gradient.
#[inline(always)]
fn density<T: Scalar, const D: usize>(h: &[[T; D]; D], lambda: &T, mu: &T) -> T {
    let (mut trace, mut squares) = (lambda.zero(), lambda.zero());
    for k in 0..D {
        trace = trace + &h[k][k];
        for l in 0..D {
            squares = squares.plus_product(&h[k][l], &(h[k][l].clone() + &h[l][k]));
        }
    }
    (lambda.clone() * &trace.squared()).plus_product(mu, &squares)
}

/// `h²` and `1 − h²`.
#[inline(always)]
fn scales<T: Scalar>(zero: &T, higher: f64) -> (T, T) {
    let h2 = zero.constant(&T::exact(higher)).squared();
    (h2.clone(), zero.one() - &h2)
}

/// `S⁻¹`, `S = Σ_a r_a r_aᵀ` about the mean of the nodes.
#[inline(always)]
pub fn inverse_spread<T: Scalar, const D: usize>(x: &[[T; D]]) -> [[T; D]; D] {
    let zero = x[0][0].zero();
    let share = zero.one() / &zero.constant(&T::exact(x.len() as f64));
    let mut mean: [T; D] = zeros(&zero);
    for x in x {
        mean = plus_multiple(&mean, &share, x);
    }
    let mut spread: [[T; D]; D] = from_fn(|_| zeros(&zero));
    for x in x {
        let r = difference(x, &mean);
        for k in 0..D {
            spread[k] = plus_multiple(&spread[k], &r[k], &r);
        }
    }
    let (adjugate, determinant) = adjugate(&spread);
    multiple(&(zero.one() / &determinant), &adjugate)
}

/// Zeros in the lower triangle.
#[inline(always)]
fn clear<T: Scalar>(gram: &mut [T], m: usize, zero: &T) {
    for s in 0..m {
        for entry in &mut gram[s * m..=s * m + s] {
            *entry = zero.clone();
        }
    }
}
