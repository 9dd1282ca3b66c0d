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
//! [`Closed`] chooses how the equations are solved.
//!
//! Theory: pages *Least squares* and *Modal weights* of the book.

use super::bounded::{Factors, bound};
use super::edge_cell::{EdgeCell, Gradients, scales};
use super::linear_motions::{LinearMotions, from_mean};
use super::node_equations::{NodeEquations, is_shorter};
use super::normal::Normal;
use super::settings::Fit;
use super::weight::{ClosedWeight, Route};
use crate::element::Tabulation;
use crate::material::Hooke;
use crate::scalar::{Packed, Real, Scalar, difference, dot, of_dimension, plus_multiple, vectorized};
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// The most bounded constants whose equations are solved by factors in all lanes at once. Beyond it one lane after the
/// other is faster.
// With 67 and 106 constants of `quad12` and `wedge15` both ways take the same time; with 191 of `hex20` and `tet20`
// factors in all lanes take 1.4 to 1.7 times as long.
const MOST_FACTORED: usize = 120;
/// The most bounded constants that are solved by factors where the equations of the nodes are solved. Beyond it
/// conjugate gradients are faster, whose products with M are cheap there.
// With 45 constants of `tet10` both ways take the same time; with 66 of `quad12` factors take twice as long, and with
// 190 of `hex20` five times.
const MOST_FACTORED_WITH_NODES: usize = 60;

/// How the equations of a fit are solved, with the working memory.
#[derive(Debug, Clone)]
pub struct Closed<T> {
    weight: ClosedWeight,
    equations: Equations,
    nonnegative: bool,
    node_equations: NodeEquations<T>,
    normal: Normal<T>,
    tied: Normal<T>,
    /// The equations before elimination, if constants are bounded.
    kept: Normal<T>,
    factors: Factors<T>,
}

/// The linear equations by which constants are found.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Equations {
    /// `M = 2I`: each constant is half of its right-hand side.
    Decoupled,
    /// The equations of the nodes are fewer than those of the springs.
    PerNode,
    /// One for each spring.
    PerSpring,
    /// One for each group of springs.
    PerGroup,
}

impl<T: Real> Closed<T> {
    /// None for objectives without a closed form.
    pub fn of(springs: &Springs, fit: &Fit) -> Option<Closed<T>> {
        let Route::Closed(weight) = fit.objective.route(springs.need_matrix()) else { return None };
        let lengths_alone = springs.content().is_none() && springs.parallel().is_empty();
        let equations = match weight {
            _ if fit.tied => Equations::PerGroup,
            // Two length springs share a block of different nodes only if they join
            // the same nodes: M is diagonal. A spring on the content is in all blocks.
            ClosedWeight::OffDiagonal if lengths_alone => Equations::Decoupled,
            ClosedWeight::None if is_shorter(springs) => Equations::PerNode,
            ClosedWeight::None | ClosedWeight::OffDiagonal | ClosedWeight::Modal(_) => Equations::PerSpring,
        };
        Some(Closed {
            weight,
            equations,
            nonnegative: fit.nonnegative,
            node_equations: NodeEquations::default(),
            normal: Normal::default(),
            tied: Normal::default(),
            kept: Normal::default(),
            factors: Factors::default(),
        })
    }

    /// Solves for the element with nodes at `x`, `[nodes × dimension]`, and fills in its geometry. Returns false if the
    /// Jacobian is not safely positive or the equations are not regular.
    pub fn solve(
        &mut self,
        table: &Tabulation,
        springs: &Springs,
        x: &[T],
        geometry: &mut Geometry<T>,
        hooke: &Hooke<T>,
    ) -> bool {
        if self.equations == Equations::PerNode {
            return geometry.update_nodes(table, x)
                && self.node_equations.solve(springs, x, geometry, hooke, &mut self.normal);
        }
        let n = springs.nodes();
        let regular = vectorized!(
            x[0],
            of_dimension!(springs.dimension(), |D| self.solve_in::<D>(n, table, springs, x, geometry, hooke))
        );
        regular && self.finish(springs)
    }

    #[inline(always)]
    fn solve_in<const D: usize>(
        &mut self,
        n: usize,
        table: &Tabulation,
        springs: &Springs,
        x: &[T],
        geometry: &mut Geometry<T>,
        hooke: &Hooke<T>,
    ) -> bool {
        if !geometry.update_in::<D>(n, table, x) {
            return false;
        }
        equations::<T, D>(n, self.weight, springs, x, geometry, hooke, &mut self.normal);
        if self.equations == Equations::Decoupled {
            for b in &mut self.normal.rhs {
                *b = b.clone().scaled(&0.5);
            }
        }
        true
    }

    /// Solves the equations.
    fn finish(&mut self, springs: &Springs) -> bool {
        let equations = match self.equations {
            Equations::Decoupled | Equations::PerNode => return true,
            Equations::PerSpring => &mut self.normal,
            Equations::PerGroup => {
                self.normal.tied(springs.groups(), springs.names().len(), &mut self.tied);
                &mut self.tied
            }
        };
        // The elimination overwrites the equations, which the search under bounds needs.
        if self.nonnegative {
            self.kept.gram.clone_from(&equations.gram);
            self.kept.rhs.clone_from(&equations.rhs);
        }
        equations.solve_regular()
    }

    /// The constant of spring `s` after [`Closed::solve`], in N/m, without bounds.
    pub fn constant(&self, springs: &Springs, s: usize) -> &T {
        match self.equations {
            Equations::PerGroup => &self.tied.rhs[springs.groups()[s]],
            Equations::Decoupled | Equations::PerNode | Equations::PerSpring => &self.normal.rhs[s],
        }
    }

    /// Solves the equations of [`Closed::solve`] for another right-hand side, one number per spring: `w ← M⁻¹ w`. Of tied springs each receives
    /// that of its group.
    pub fn solve_again(&mut self, springs: &Springs, w: &mut [T]) {
        let Some(any) = w.first().cloned() else { return };
        vectorized!(
            any,
            match self.equations {
                Equations::Decoupled => {
                    for w in &mut *w {
                        *w = w.clone().scaled(&0.5);
                    }
                }
                Equations::PerNode => self.node_equations.solve_again(springs, w),
                Equations::PerSpring => self.normal.substitute(w),
                Equations::PerGroup => {
                    let mut sums = vec![any.zero(); springs.names().len()];
                    // The equations of groups are sums over their springs, and so is their right-hand side.
                    for (w, &group) in w.iter().zip(springs.groups()) {
                        sums[group] = sums[group].clone() + w;
                    }
                    self.tied.substitute(&mut sums);
                    for (w, &group) in w.iter_mut().zip(springs.groups()) {
                        *w = sums[group].clone();
                    }
                }
            }
        );
    }

    /// The weight of the norm.
    pub fn weight(&self) -> ClosedWeight {
        self.weight
    }

    /// The equations of a single element, one per spring.
    pub fn equations_alone(&self, springs: &Springs, x: &[f64], geometry: &Geometry, hooke: &Hooke) -> Normal {
        let mut normal = Normal::default();
        normal_equations(self.weight, springs, x, geometry, hooke, &mut normal);
        normal
    }

    /// The equations that [`Closed::solve`] solved, for bounded constants; none if each constant has an equation of its
    /// own.
    pub fn equations(
        &mut self,
        springs: &Springs,
        x: &[T],
        geometry: &Geometry<T>,
        hooke: &Hooke<T>,
    ) -> Option<&Normal<T>> {
        match self.equations {
            Equations::Decoupled => None,
            // The nodes were solved without any equation of a spring, which is worked out only now, for the few cells with bounds.
            Equations::PerNode => {
                normal_equations(self.weight, springs, x, geometry, hooke, &mut self.normal);
                Some(&self.normal)
            }
            Equations::PerSpring | Equations::PerGroup => Some(&self.kept),
        }
    }
}

impl<T: Packed> Closed<T> {
    /// Replaces the constants of these lanes, after [`Closed::solve`], by the optimum under `k ≥ 0`. False, with nothing changed, where each
    /// constant has an equation of its own, there are too many of them, or the search does not end.
    pub fn bound(
        &mut self,
        springs: &Springs,
        x: &[T],
        geometry: &Geometry<T>,
        hooke: &Hooke<T>,
        lanes: &[usize],
    ) -> bool {
        match self.equations {
            Equations::Decoupled => return false,
            Equations::PerNode if springs.len() > MOST_FACTORED_WITH_NODES => {
                return self.node_equations.bound(springs, &mut self.normal.rhs, lanes);
            }
            // The equations of the nodes have no rows of single springs, which bounds need.
            Equations::PerNode => normal_equations(self.weight, springs, x, geometry, hooke, &mut self.kept),
            Equations::PerSpring | Equations::PerGroup if self.kept.size() > MOST_FACTORED => return false,
            Equations::PerSpring | Equations::PerGroup => {}
        }
        let k = if self.equations == Equations::PerGroup { &mut self.tied.rhs } else { &mut self.normal.rhs };
        self.factors.set(&self.kept);
        bound(&mut self.factors, &self.kept.rhs, k, lanes)
    }
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
    vectorized!(
        x[0],
        of_dimension!(springs.dimension(), |D| equations::<T, D>(n, weight, springs, x, geometry, hooke, normal))
    );
}

/// [`normal_equations`] in D dimensions, as part of a kernel.
#[inline(always)]
fn equations<T: Scalar, const D: usize>(
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
