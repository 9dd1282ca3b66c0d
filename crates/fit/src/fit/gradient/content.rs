//! The slopes that come through the spring on the content of a cell.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::closed::LeastSquaresCell;
use super::modal::Modal;
use super::slopes::{Slopes, add};
use crate::fit::weight::ClosedWeight;
use crate::material::Moduli;
use crate::scalar::{Real, difference, dot};

impl<T: Real> LeastSquaresCell<'_, T> {
    /// Adds the slopes in the row of the content in M, and in its entry in b.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "the vectors of the springs, and the slopes in them")]
    pub fn add_content<const D: usize>(
        &self,
        n: usize,
        d: &[[T; D]],
        q: &[T],
        images: &[[T; D]],
        of_d: &mut [[T; D]],
        of_q: &mut [T],
        of_c: &mut [[T; D]],
        modal: &mut Option<Modal<T, D>>,
        slopes: &mut Slopes<T>,
    ) {
        let zero = self.x[0].zero();
        let last = self.springs.len() - 1;
        let (pairs, is_apart) = (self.springs.pairs(), self.weight == ClosedWeight::OffDiagonal);
        let gradient = self.geometry.content_gradient();
        let c = &gradient.as_chunks::<D>().0[..n];
        let volume = self.geometry.content();
        of_c.iter_mut().for_each(|slope| *slope = zero.repeated());
        let h2 = modal.as_ref().map_or(zero.one(), |modal| modal.h2.clone());
        let mut of_volume = zero.clone();
        for s in 0..d.len() {
            let ([i, j], share) = (pairs[s], self.share(s, last));
            if is_apart {
                // −2 q (d·c_i)(d·c_j)
                let (ci, cj) = (dot(&d[s], &c[i]), dot(&d[s], &c[j]));
                let twice = share.scaled(&-2.0);
                of_q[s] = of_q[s].clone().plus_product(&(twice.clone() * &ci), &cj);
                let scale = twice * &q[s];
                let (of_i, of_j) = (scale.clone() * &cj, scale * &ci);
                add(&mut of_d[s], &of_i, &c[i]);
                add(&mut of_d[s], &of_j, &c[j]);
                add(&mut of_c[i], &of_i, &d[s]);
                add(&mut of_c[j], &of_j, &d[s]);
                continue;
            }
            // (h² d·(c_j − c_i) + V d·B d)² q
            let change = difference(&c[j], &c[i]);
            let mut along = h2.clone() * &dot(&d[s], &change);
            let turned = if modal.is_some() { dot(&d[s], &images[s]) } else { zero.clone() };
            along = along.plus_product(&volume, &turned);
            of_q[s] = of_q[s].clone().plus_product(&share, &along.clone().squared());
            let of_along = (share * &along * &q[s]).scaled(&2.0);
            let of_change = of_along.clone() * &h2;
            add(&mut of_d[s], &of_change, &change);
            add(&mut of_c[j], &of_change, &d[s]);
            add(&mut of_c[i], &of_change.negated(), &d[s]);
            if let Some(modal) = modal {
                of_volume = of_volume.plus_product(&of_along, &turned);
                let of_turned = of_along * &volume;
                add(&mut of_d[s], &of_turned.clone().scaled(&2.0), &images[s]);
                for k in 0..D {
                    let share = of_turned.clone() * &d[s][k];
                    add(&mut modal.of_b[k], &share, &d[s]);
                }
            }
        }
        // (h² Σ c² + V² tr B)², or (Σ c²)² − Σ c⁴
        let mut cc = zero.clone();
        for c in c {
            cc = cc + &dot(c, c);
        }
        let own = (self.p[last].clone() * &self.k[last]).negated();
        if is_apart {
            for a in 0..n {
                let size = cc.clone() - &dot(&c[a], &c[a]);
                add(&mut of_c[a], &(own.clone() * &size).scaled(&4.0), &c[a]);
            }
        } else {
            let mut trace = zero.clone();
            if let Some(modal) = modal {
                for k in 0..D {
                    trace = trace + &modal.b[k][k];
                }
            }
            let square = volume.clone().squared();
            let root = (h2.clone() * &cc).plus_product(&square, &trace);
            let of_root = (own * &root).scaled(&2.0);
            let of_each = (of_root.clone() * &h2).scaled(&2.0);
            for a in 0..n {
                add(&mut of_c[a], &of_each, &c[a]);
            }
            if let Some(modal) = modal {
                of_volume = of_volume.plus_product(&(of_root.clone() * &trace).scaled(&2.0), &volume);
                let share = of_root * &square;
                for k in 0..D {
                    modal.of_b[k][k] = modal.of_b[k][k].clone() + &share;
                }
            }
        }
        // Σ_q λ w (tr H)² + μ v (H : H + H : Hᵀ), H = V B + h² Σ_a c_a G_aᵀ; without the sum over a of the same of each c_a G_aᵀ.
        let p = &self.p[last];
        let mut linear: [[T; D]; D] = zero.repeated_rows();
        if let Some(modal) = modal {
            for k in 0..D {
                for l in 0..D {
                    linear[k][l] = modal.b[k][l].clone() * &volume;
                }
            }
        }
        let mut of_linear: [[T; D]; D] = zero.repeated_rows();
        for (at, (grad, v, w)) in self.geometry.each_point().enumerate() {
            let grad = &grad.as_chunks::<D>().0[..n];
            let of_grad = &mut slopes.gradients[at * n * D..(at + 1) * n * D].as_chunks_mut::<D>().0[..n];
            let mut h = linear.clone();
            for a in 0..n {
                for k in 0..D {
                    let share = h2.clone() * &c[a][k];
                    add(&mut h[k], &share, &grad[a]);
                }
            }
            let mut point = PointSlopes { moduli: self.moduli, v, w, of: [zero.clone(), zero.clone()] };
            let of_h = point.energy(&h, p);
            for k in 0..D {
                for l in 0..D {
                    of_linear[k][l] = of_linear[k][l].clone() + &of_h[k][l];
                }
            }
            for a in 0..n {
                for k in 0..D {
                    let share = h2.clone() * &c[a][k];
                    add(&mut of_grad[a], &share, &of_h[k]);
                    of_c[a][k] = of_c[a][k].clone().plus_product(&h2, &dot(&of_h[k], &grad[a]));
                }
            }
            if is_apart {
                let less = p.negated();
                for a in 0..n {
                    let mut outer: [[T; D]; D] = zero.repeated_rows();
                    for k in 0..D {
                        add(&mut outer[k], &c[a][k], &grad[a]);
                    }
                    let of_outer = point.energy(&outer, &less);
                    for k in 0..D {
                        add(&mut of_grad[a], &c[a][k], &of_outer[k]);
                        of_c[a][k] = of_c[a][k].clone() + &dot(&of_outer[k], &grad[a]);
                    }
                }
            }
            // The energy has a term with λ w and one with μ v.
            let [volumetric, shear] = point.of;
            slopes.moduli[0] = slopes.moduli[0].clone().plus_product(&volumetric, w);
            slopes.moduli[1] = slopes.moduli[1].clone().plus_product(&shear, v);
            slopes.volumetric[at] = slopes.volumetric[at].clone().plus_product(&volumetric, &self.moduli.lambda);
            slopes.volumes[at] = slopes.volumes[at].clone().plus_product(&shear, &self.moduli.mu);
        }
        if let Some(modal) = modal {
            for k in 0..D {
                of_volume = of_volume + &dot(&of_linear[k], &modal.b[k]);
                add(&mut modal.of_b[k], &volume, &of_linear[k]);
            }
        }
        // c_a = Σ_q v G_a, V = Σ_q v
        slopes.add_content(&of_volume);
        for (at, (grad, v, _)) in self.geometry.each_point().enumerate() {
            let grad = &grad.as_chunks::<D>().0[..n];
            let of_grad = &mut slopes.gradients[at * n * D..(at + 1) * n * D].as_chunks_mut::<D>().0[..n];
            for a in 0..n {
                slopes.volumes[at] = slopes.volumes[at].clone() + &dot(&of_c[a], &grad[a]);
                add(&mut of_grad[a], v, &of_c[a]);
            }
        }
    }
}

/// A quadrature point with the slopes in `λ w` and `μ v`.
struct PointSlopes<'a, T> {
    moduli: &'a Moduli<T>,
    v: &'a T,
    w: &'a T,
    of: [T; 2],
}

impl<T: Real> PointSlopes<'_, T> {
    /// The slopes in H of `p (λ w (tr H)² + μ v (H : H + H : Hᵀ))`.
    #[inline(always)]
    fn energy<const D: usize>(&mut self, h: &[[T; D]; D], p: &T) -> [[T; D]; D] {
        let mut trace = p.zero();
        for k in 0..D {
            trace = trace + &h[k][k];
        }
        let (volumetric, shear) = (self.moduli.lambda.clone() * self.w, self.moduli.mu.clone() * self.v);
        let mut squares = p.zero();
        let mut of_h: [[T; D]; D] = p.zero().repeated_rows();
        let twice = (shear * p).scaled(&2.0);
        for k in 0..D {
            for l in 0..D {
                let both = h[k][l].clone() + &h[l][k];
                squares = squares.plus_product(&h[k][l], &both);
                of_h[k][l] = twice.clone() * &both;
            }
            of_h[k][k] = of_h[k][k].clone().plus_product(&(volumetric.clone() * p).scaled(&2.0), &trace);
        }
        self.of[0] = self.of[0].clone().plus_product(p, &trace.squared());
        self.of[1] = self.of[1].clone().plus_product(p, &squares);
        of_h
    }
}
