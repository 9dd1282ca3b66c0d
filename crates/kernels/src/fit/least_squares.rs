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

use super::input::check_length;
use super::linear_motions::{LinearMotions, from_mean};
use super::normal::Normal;
use super::weight::{ClosedWeight, Higher, Weight};
use crate::element::Tabulation;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{Hooke, Moduli};
use crate::scalar::{Scalar, difference, dot, plus_multiple};
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
    let weight = weight.closed(!springs.functions.is_empty())?;
    if (table.nodes, table.dimension) != (springs.nodes, springs.dimension) {
        let expected = format!("a table of {} nodes in {} dimensions", springs.nodes, springs.dimension);
        return Err(Error::expected("table", expected, format!("{} in {}", table.nodes, table.dimension)));
    }
    check_length("x", x.len(), springs.nodes * springs.dimension)?;
    let none = |problem: &str| Error::new(problem).of_kind(ErrorKind::Infeasible);
    let mut geometry = Geometry::like(&x[0], table);
    if !geometry.update(table, x) {
        return Err(none("the Jacobian is not positive everywhere"));
    }
    let mut normal = Normal::default();
    normal_equations(weight, springs, x, &geometry, &moduli.of_kind(&x[0]), &mut normal);
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
    moduli: &Moduli<T>,
    normal: &mut Normal<T>,
) {
    let n = springs.nodes;
    x[0].vectorize(
        #[inline(always)]
        || match springs.dimension {
            1 => equations::<T, 1>(n, weight, springs, x, geometry, moduli, normal),
            2 => equations::<T, 2>(n, weight, springs, x, geometry, moduli, normal),
            _ => equations::<T, 3>(n, weight, springs, x, geometry, moduli, normal),
        },
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
    moduli: &Moduli<T>,
    normal: &mut Normal<T>,
) {
    let x = &x.as_chunks::<D>().0[..n];
    let zero = x[0][0].zero();
    let (m, lengths) = (springs.len(), springs.pairs.len());
    let pairs = &springs.pairs[..];
    let Normal { gram, rhs, edges, inverse_squares: q, images, positions, .. } = normal;
    gram.resize(m * m, zero.clone());
    images.resize(lengths * D, zero.clone());
    let images = images.as_chunks_mut::<D>().0;
    let cell = EdgeCell::new(springs, x, geometry, moduli, edges, q, rhs);
    let edges = cell.edges;
    let two = zero.one() + &zero.one();
    match weight {
        ClosedWeight::None => {
            cell.plain_energies(rhs);
            clear(gram, m, &zero);
            for &(s, t) in &springs.touching {
                gram[t * m + s] = cell.cosine_squared(s, t);
            }
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
                    let w = plus_multiple(&of_springs[s], &h2, &plain);
                    (dot(&edges[s], &w).squared(), dot(&w, &w))
                },
            );
            // g_s·y_t = (h² c_st + (1 − h²) d_sᵀ S⁻¹ d_t) n_s·n_t, with d_sᵀ S⁻¹ d_t in the basis where S is diagonal,
            // and c_st the number of shared ends of equal sign less those of unequal sign.
            for t in 0..lengths {
                images[t] = difference(&q[pairs[t][1]], &q[pairs[t][0]]);
                let along = linear.weighted(&rest, &images[t]);
                for s in 0..=t {
                    let ([a, b], [c, d]) = (pairs[s], pairs[t]);
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
    if springs.content.is_some() {
        cell.content(weight, &mut gram[(m - 1) * m..m * m], rhs);
    }
}

/// The equations of the blocks of different nodes if springs measure functions, of which only g is known, or R is that of an anisotropic law:
/// `M_st = (g_s·g_t)² − Σ_a (g_sa·g_ta)²`, `b_s = g_sᵀ R g_s − Σ_a g_saᵀ R_aa g_sa`.
pub fn off_diagonal_equations(springs: &Springs, x: &[f64], geometry: &Geometry, hooke: &Hooke) -> Normal {
    let (d, m, size) = (springs.dimension, springs.len(), x.len());
    let r = geometry.stiffness(hooke);
    let mut g = Vec::new();
    springs.gradients(x, geometry, &mut g);
    let row = |s: usize| &g[s * size..(s + 1) * size];
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut normal = Normal::new(vec![0.0; m * m], vec![0.0; m]);
    for s in 0..m {
        for t in 0..=s {
            let alone = row(s).chunks_exact(d).zip(row(t).chunks_exact(d)).map(|(a, b)| dot(a, b).powi(2));
            normal.gram[s * m + t] = dot(row(s), row(t)).powi(2) - alone.sum::<f64>();
        }
        for i in 0..size {
            let others = (0..size).filter(|j| j / d != i / d);
            normal.rhs[s] += row(s)[i] * others.map(|j| r[(i, j)] * row(s)[j]).sum::<f64>();
        }
    }
    normal
}

/// One element, or one per lane, with the vectors of its length springs.
pub struct EdgeCell<'a, T, const D: usize> {
    springs: &'a Springs,
    x: &'a [[T; D]],
    /// `d_s = x_j − x_i`
    pub edges: &'a [[T; D]],
    /// `1/‖d_s‖²`
    pub q: &'a [T],
    geometry: &'a Geometry<T>,
    lambda: T,
    mu: T,
}

impl<'a, T: Scalar, const D: usize> EdgeCell<'a, T, D> {
    /// Fills `edges` and `q` with those of the element, and `rhs` with zeros.
    #[inline(always)]
    pub fn new(
        springs: &'a Springs,
        x: &'a [[T; D]],
        geometry: &'a Geometry<T>,
        moduli: &Moduli<T>,
        edges: &'a mut Vec<T>,
        q: &'a mut Vec<T>,
        rhs: &mut Vec<T>,
    ) -> EdgeCell<'a, T, D> {
        let zero = x[0][0].zero();
        let lengths = springs.pairs.len();
        rhs.clear();
        rhs.resize(springs.len(), zero.clone());
        edges.resize(lengths * D, zero.clone());
        q.resize(lengths, zero.clone());
        let edges = edges.as_chunks_mut::<D>().0;
        for ((d, q), &[i, j]) in edges.iter_mut().zip(&mut *q).zip(&springs.pairs) {
            *d = difference(&x[j], &x[i]);
            *q = zero.one() / &dot(d, d);
        }
        let (lambda, mu) = (moduli.lambda.clone(), moduli.mu.clone());
        EdgeCell { springs, x, edges, q: &q[..lengths], geometry, lambda, mu }
    }

    /// `b_s = g_sᵀ R g_s` of the length springs.
    #[inline(always)]
    pub fn plain_energies(&self, rhs: &mut [T]) {
        let (edges, pairs) = (self.edges, &self.springs.pairs[..]);
        self.energies(
            rhs,
            #[inline(always)]
            |s, grad: &[[T; D]]| {
                let w = difference(&grad[pairs[s][1]], &grad[pairs[s][0]]);
                (dot(&edges[s], &w).squared(), dot(&w, &w))
            },
        );
    }

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
        for (grad, v, w) in self.geometry.each_point() {
            let grad = &grad.as_chunks::<D>().0[..n];
            let across = self.mu.clone() * v;
            let along = (self.lambda.clone() * w) + &across;
            for (s, b) in rhs.iter_mut().enumerate() {
                let (squared, plain) = terms(s, grad);
                let energy = b.clone().plus_product(&across, &plain);
                *b = energy.plus_product(&(along.clone() * &self.q[s]), &squared);
            }
        }
    }

    /// The last row of `M` and entry of `b`, of the spring on the cell's content, whose `g` is `c = ∫ ∇N dV`. With V
    /// the content, `P c = V S⁻¹ r_a`, because `Σ_a r_a ∇N_aᵀ = I`.
    pub fn content(&self, weight: ClosedWeight, row: &mut [T], rhs: &mut [T]) {
        self.lambda.vectorize(
            #[inline(always)]
            || self.add_content(weight, row, rhs),
        );
    }

    #[inline(always)]
    fn add_content(&self, weight: ClosedWeight, row: &mut [T], rhs: &mut [T]) {
        let last = self.springs.len() - 1;
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
        let (mut h2, mut linear) = (zero.one(), zero.repeated_rows());
        let mut q = self.x.to_vec();
        let mut motions = None;
        match weight {
            ClosedWeight::None | ClosedWeight::OffDiagonal => {}
            ClosedWeight::Modal(higher) => {
                let rest;
                (h2, rest) = scales(&zero, higher);
                from_mean(self.x, &mut q);
                let (found, factor) = (LinearMotions::of(&mut q), rest * &volume);
                linear = found.inverse_spread(&factor);
                motions = Some((found, factor));
            }
        }
        for (s, &[i, j]) in self.springs.pairs.iter().enumerate() {
            let d = &self.edges[s];
            row[s] = match weight {
                ClosedWeight::OffDiagonal => {
                    zero.clone() - &(two.clone() * &self.q[s] * &dot(d, &c[i]) * &dot(d, &c[j]))
                }
                ClosedWeight::None | ClosedWeight::Modal(_) => {
                    let mut along = h2.clone() * &dot(d, &difference(&c[j], &c[i]));
                    if let Some((motions, factor)) = &motions {
                        let turned = difference(&q[j], &q[i]);
                        along = along + &dot(&turned, &motions.weighted(factor, &turned));
                    }
                    along.squared() * &self.q[s]
                }
            };
        }
        row[last] = match weight {
            ClosedWeight::OffDiagonal => cc.squared() - &fourth,
            ClosedWeight::None | ClosedWeight::Modal(_) => {
                let mut trace = linear[0][0].clone();
                for k in 1..D {
                    trace = trace + &linear[k][k];
                }
                (h2.clone() * &cc).plus_product(&trace, &volume).squared()
            }
        };
        for (grad, v, w) in self.geometry.each_point() {
            let grad = grad.as_chunks::<D>().0;
            let (lambda, mu) = (self.lambda.clone() * w, self.mu.clone() * v);
            let mut h = linear.clone();
            let mut alone = zero.clone();
            for (c, g) in c.iter().zip(grad) {
                let mut outer: [[T; D]; D] = zero.repeated_rows();
                for k in 0..D {
                    for l in 0..D {
                        outer[k][l] = c[k].clone() * &g[l];
                        h[k][l] = h[k][l].clone().plus_product(&h2, &outer[k][l]);
                    }
                }
                if weight == ClosedWeight::OffDiagonal {
                    alone = alone + &density(&outer, &lambda, &mu);
                }
            }
            rhs[last] = rhs[last].clone() + &(density(&h, &lambda, &mu) - &alone);
        }
    }
}

/// Twice the energy density, `λ (tr H)² + μ (H : H + H : Hᵀ)`, of a displacement gradient H.
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
fn scales<T: Scalar>(zero: &T, higher: Higher) -> (T, T) {
    let h2 = zero.constant(&T::exact(higher.value())).squared();
    (h2.clone(), zero.one() - &h2)
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
