//! The slopes of constants of least squares.
//!
//! With `M k = b` the slope of `wᵀ k` is that of `φ = pᵀ b − pᵀ M k`, `M p = w`, in which p and k do not change: the same factors solve for
//! p, and nothing of the elimination is differentiated. The lines below are the transposes of those that set up M and b.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::modal::Modal;
use super::slopes::{Slopes, add};
use crate::fit::edge_cell::scales;
use crate::fit::weight::ClosedWeight;
use crate::material::Moduli;
use crate::scalar::{Real, difference, dot, plus_multiple, product};
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// The cell whose constants are k, with p as above, and memory for the slopes in the vectors of its springs.
pub struct LeastSquaresCell<'a, T> {
    pub weight: ClosedWeight,
    pub springs: &'a Springs,
    pub x: &'a [T],
    pub geometry: &'a Geometry<T>,
    pub moduli: &'a Moduli<T>,
    /// `[springs]`.
    pub k: &'a [T],
    /// `[springs]`.
    pub p: &'a [T],
}

/// Slopes in the edges `d_s = x_j − x_i`, in `1/‖d_s‖²`, in the images `B d_s`, in `B = (1 − h²) S⁻¹`, in the gradient c of the content and in
/// the content.
pub struct EdgeSlopes<T> {
    edges: Vec<T>,
    inverse_squares: Vec<T>,
    images: Vec<T>,
    /// The edges, `1/‖d_s‖²` and the images themselves.
    d: Vec<T>,
    q: Vec<T>,
    bd: Vec<T>,
    content: Vec<T>,
}

impl<T: Real> EdgeSlopes<T> {
    /// Memory for so many springs in D dimensions.
    pub fn like(zero: &T, springs: &Springs) -> EdgeSlopes<T> {
        let (m, d) = (springs.pairs().len(), springs.dimension());
        let of = |count: usize| vec![zero.clone(); count];
        EdgeSlopes {
            edges: of(m * d),
            inverse_squares: of(m),
            images: of(m * d),
            d: of(m * d),
            q: of(m),
            bd: of(m * d),
            content: of(springs.nodes() * d),
        }
    }
}

impl<T: Real> LeastSquaresCell<'_, T> {
    /// Adds the slopes of φ to those in the nodes, the geometry and the moduli.
    #[inline(always)]
    pub fn add_slopes<const D: usize>(&self, n: usize, room: &mut EdgeSlopes<T>, slopes: &mut Slopes<T>) {
        let zero = self.x[0].zero();
        let x = &self.x.as_chunks::<D>().0[..n];
        let pairs = self.springs.pairs();
        let m = pairs.len();
        let (of_d, of_q) = (&mut room.edges.as_chunks_mut::<D>().0[..m], &mut room.inverse_squares[..m]);
        let (d, q) = (&mut room.d.as_chunks_mut::<D>().0[..m], &mut room.q[..m]);
        for s in 0..m {
            let [i, j] = pairs[s];
            d[s] = difference(&x[j], &x[i]);
            q[s] = zero.one() / &dot(&d[s], &d[s]);
            of_d[s] = zero.repeated();
            of_q[s] = zero.clone();
        }
        let mut modal = match self.weight {
            ClosedWeight::None | ClosedWeight::OffDiagonal => None,
            ClosedWeight::Modal(higher) => {
                let (h2, rest) = scales(&zero, higher);
                Some(Modal::of(x, h2, rest))
            }
        };
        let (images, of_images) =
            (&mut room.bd.as_chunks_mut::<D>().0[..m], &mut room.images.as_chunks_mut::<D>().0[..m]);
        if let Some(modal) = &modal {
            for s in 0..m {
                images[s] = product(&modal.b, &d[s]);
                of_images[s] = zero.repeated();
            }
        }
        let (d, q, images) = (&*d, &*q, &*images);
        let h2 = modal.as_ref().map_or(zero.one(), |modal| modal.h2.clone());

        // b_s of the length springs
        let two = zero.constant(&2.0);
        let all = slopes.gradients.chunks_exact_mut(n * D).zip(slopes.volumes.iter_mut().zip(&mut slopes.volumetric));
        for ((grad, v, w), (of_grad, (of_v, of_w))) in self.geometry.each_point().zip(all) {
            let (grad, of_grad) = (&grad.as_chunks::<D>().0[..n], &mut of_grad.as_chunks_mut::<D>().0[..n]);
            let across = self.moduli.mu.clone() * v;
            let along = (self.moduli.lambda.clone() * w) + &across;
            let (mut of_across, mut of_along) = (zero.clone(), zero.clone());
            for s in 0..m {
                let ([i, j], p) = (pairs[s], &self.p[s]);
                let stretch = along.clone() * &q[s];
                // The work of two gradients has slopes in both; those of one gradient twice are shorter.
                if self.weight == ClosedWeight::OffDiagonal {
                    let (y, z) = (&grad[i], &grad[j]);
                    let p = p.clone().scaled(&-2.0);
                    let (dy, dz) = (dot(&d[s], y), dot(&d[s], z));
                    let both = dy.clone() * &dz;
                    of_across = of_across.plus_product(&p, &dot(y, z));
                    of_along = of_along.plus_product(&(p.clone() * &q[s]), &both);
                    of_q[s] = of_q[s].clone().plus_product(&(p.clone() * &along), &both);
                    let (turn, stretch) = (p.clone() * &across, p * &stretch);
                    let (by, bz) = (stretch.clone() * &dy, stretch * &dz);
                    let (y, z) = (y.clone(), z.clone());
                    add(&mut of_d[s], &bz, &y);
                    add(&mut of_d[s], &by, &z);
                    add(&mut of_grad[i], &turn, &z);
                    add(&mut of_grad[i], &bz, &d[s]);
                    add(&mut of_grad[j], &turn, &y);
                    add(&mut of_grad[j], &by, &d[s]);
                    continue;
                }
                let mut y = difference(&grad[j], &grad[i]);
                if modal.is_some() {
                    for k in 0..D {
                        y[k] = images[s][k].clone().plus_product(&h2, &y[k]);
                    }
                }
                let dy = dot(&d[s], &y);
                let square = dy.clone().squared();
                of_across = of_across.plus_product(p, &dot(&y, &y));
                of_along = of_along.plus_product(&(p.clone() * &q[s]), &square);
                of_q[s] = of_q[s].clone().plus_product(&(p.clone() * &along), &square);
                let twice = two.clone() * p;
                let (turn, stretch) = (twice.clone() * &across, twice * &stretch * &dy);
                add(&mut of_d[s], &stretch, &y);
                let mut of_y: [T; D] = zero.repeated();
                add(&mut of_y, &turn, &y);
                add(&mut of_y, &stretch, &d[s]);
                if modal.is_some() {
                    of_images[s] = plus_multiple(&of_images[s], &zero.one(), &of_y);
                    for k in 0..D {
                        of_y[k] = of_y[k].clone() * &h2;
                    }
                }
                for k in 0..D {
                    of_grad[j][k] = of_grad[j][k].clone() + &of_y[k];
                    of_grad[i][k] = of_grad[i][k].clone() - &of_y[k];
                }
            }
            // across = μ v, along = λ w + across
            // `along` contains `across`, so that its slope counts for both.
            let of_across = of_across + &of_along;
            *of_v = of_v.clone().plus_product(&of_across, &self.moduli.mu);
            *of_w = of_w.clone().plus_product(&of_along, &self.moduli.lambda);
            slopes.moduli[0] = slopes.moduli[0].clone().plus_product(&of_along, w);
            slopes.moduli[1] = slopes.moduli[1].clone().plus_product(&of_across, v);
        }

        // −pᵀ M k of the length springs
        match (&self.weight, &modal) {
            (ClosedWeight::None, _) => {
                for &(s, t) in self.springs.touching() {
                    let share = self.share(s, t);
                    add_cosine(&zero, [s, t], &share, d, q, of_d, of_q);
                }
            }
            (ClosedWeight::Modal(_), Some(_)) => {
                for t in 0..m {
                    for s in 0..=t {
                        let ([a, b], [e, f]) = (pairs[s], pairs[t]);
                        let ends = i8::from(a == e) + i8::from(b == f) - i8::from(a == f) - i8::from(b == e);
                        let mut factor = dot(&d[s], &images[t]);
                        if ends != 0 {
                            factor = factor.plus_product(&h2, &zero.constant(&ends.into()));
                        }
                        // A diagonal entry is there once, and one beside it twice.
                        let share = if s == t { (self.p[s].clone() * &self.k[s]).negated() } else { self.share(s, t) };
                        let cosine = dot(&d[s], &d[t]);
                        let squared = cosine.squared() * &(q[s].clone() * &q[t]);
                        let of_factor = share.clone() * &factor * &squared * &two;
                        add(&mut of_d[s], &of_factor, &images[t]);
                        add(&mut of_images[t], &of_factor, &d[s]);
                        // `n_s·n_s` is one and has no slope.
                        if s != t {
                            add_cosine(&zero, [s, t], &(share * &factor.squared()), d, q, of_d, of_q);
                        }
                    }
                }
            }
            (ClosedWeight::OffDiagonal | ClosedWeight::Modal(_), _) => {}
        }

        if self.springs.content().is_some() {
            let of_content = &mut room.content.as_chunks_mut::<D>().0[..n];
            self.add_content(n, d, q, images, of_d, of_q, of_content, &mut modal, slopes);
        }

        // The images B d, B = (1 − h²) S⁻¹, S = Σ r rᵀ
        if let Some(modal) = &mut modal {
            for s in 0..m {
                for k in 0..D {
                    for l in 0..D {
                        of_d[s][l] = of_d[s][l].clone().plus_product(&modal.b[k][l], &of_images[s][k]);
                        modal.of_b[k][l] = modal.of_b[k][l].clone().plus_product(&of_images[s][k], &d[s][l]);
                    }
                }
            }
            modal.add_slopes(x, slopes);
        }
        let of_x = &mut slopes.x.as_chunks_mut::<D>().0[..n];
        for s in 0..m {
            let [i, j] = pairs[s];
            // ∂(1/‖d‖²)/∂d = −2 d/‖d‖⁴
            let shrink = (of_q[s].clone() * &q[s].clone().squared()).scaled(&-2.0);
            for k in 0..D {
                let slope = of_d[s][k].clone().plus_product(&shrink, &d[s][k]);
                of_x[j][k] = of_x[j][k].clone() + &slope;
                of_x[i][k] = of_x[i][k].clone() - &slope;
            }
        }
    }

    /// `−(p_s k_t + p_t k_s)`, the slope of φ in the two equal entries `M_st` and `M_ts`.
    #[inline(always)]
    pub fn share(&self, s: usize, t: usize) -> T {
        (self.p[s].clone() * &self.k[t]).plus_product(&self.p[t], &self.k[s]).negated()
    }
}

/// The slopes of `share (n_s·n_t)²`.
#[inline(always)]
fn add_cosine<T: Real, const D: usize>(
    zero: &T,
    [s, t]: [usize; 2],
    share: &T,
    d: &[[T; D]],
    q: &[T],
    of_d: &mut [[T; D]],
    of_q: &mut [T],
) {
    let cosine = dot(&d[s], &d[t]);
    let scaled = share.clone() * &cosine;
    let squared = scaled.clone() * &cosine;
    of_q[s] = of_q[s].clone().plus_product(&squared, &q[t]);
    of_q[t] = of_q[t].clone().plus_product(&squared, &q[s]);
    let turn = scaled * &(q[s].clone() * &q[t]) * &zero.constant(&2.0);
    add(&mut of_d[s], &turn, &d[t]);
    add(&mut of_d[t], &turn, &d[s]);
}
