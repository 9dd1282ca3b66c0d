//! The slopes of the springs of exact networks, by hand: each line is the transpose of one of the kernel.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::slopes::Slopes;
use crate::fit::exact::ExactKernel;
use crate::material::Moduli;
use crate::scalar::{Real, dot};
use crate::stiffness::Geometry;

/// Adds the slopes of `Σ_s w_s k_s + Σ_c r_c c_c` over the springs on lengths (first) and on contents, and over the rest contents, to those
/// in the geometry and in the moduli.
#[inline(always)]
pub fn add_exact<T: Real, const D: usize>(
    n: usize,
    kernel: &ExactKernel,
    moduli: &Moduli<T>,
    geometry: &Geometry<T>,
    weights: &[T],
    rests: &[T],
    slopes: &mut Slopes<T>,
) {
    // k_ab = −μ Σ_q v_q G_a·G_b
    let pairs = n * (n - 1) / 2;
    let of_pairs = &weights[..pairs];
    let all = slopes.gradients.chunks_exact_mut(n * D).zip(&mut slopes.volumes);
    for ((grad, v, _), (of_grad, of_volume)) in geometry.each_point().zip(all) {
        let (grad, of_grad) = (&grad.as_chunks::<D>().0[..n], &mut of_grad.as_chunks_mut::<D>().0[..n]);
        let factor = (v.clone() * &moduli.mu).negated();
        let mut sum = v.zero();
        let mut s = 0;
        for a in 0..n {
            for b in a + 1..n {
                let w = &of_pairs[s];
                sum = sum.plus_product(w, &dot(&grad[a], &grad[b]));
                let share = factor.clone() * w;
                for k in 0..D {
                    of_grad[a][k] = of_grad[a][k].clone().plus_product(&share, &grad[b][k]);
                    of_grad[b][k] = of_grad[b][k].clone().plus_product(&share, &grad[a][k]);
                }
                s += 1;
            }
        }
        *of_volume = of_volume.clone().minus_product(&sum, &moduli.mu);
        slopes.moduli[1] = slopes.moduli[1].clone().minus_product(&sum, v);
    }
    let volumes = &geometry.volumes;
    let volumetric = if geometry.volumetric.is_empty() { volumes } else { &geometry.volumetric };
    let mut springs = weights[pairs..].iter().zip(rests);
    for &q in kernel.springs.points() {
        let Some((k, rest)) = springs.next() else { return };
        // The content of a point without a volume is that in the term λ (div u)².
        let is_zero = volumes[q].magnitude().choose(&volumes[q].zero(), &volumes[q].one());
        let content = volumes[q].magnitude().choose(&volumes[q], &volumetric[q]);
        let found = spring(moduli, kernel.shares.points, [&content, &volumes[q], &volumetric[q]], k, rest);
        let [own, volume, whole] = found.contents;
        let of_volumetric = whole.plus_product(&own, &is_zero);
        let of_volume = volume + &own.clone().minus_product(&own, &is_zero);
        slopes.volumes[q] = slopes.volumes[q].clone() + &of_volume;
        slopes.volumetric[q] = slopes.volumetric[q].clone() + &of_volumetric;
        add_moduli(slopes, &found.moduli);
    }
    if let Some((k, rest)) = springs.next() {
        let (mut content, mut whole) = (volumes[0].clone(), volumetric[0].clone());
        for (v, w) in volumes.iter().zip(volumetric).skip(1) {
            content = content + v;
            whole = whole + w;
        }
        let found = spring(moduli, kernel.shares.cell, [&content, &content, &whole], k, rest);
        let [own, volume, of_whole] = found.contents;
        slopes.add_content(&(own + &volume));
        for slope in &mut slopes.volumetric {
            *slope = slope.clone() + &of_whole;
        }
        add_moduli(slopes, &found.moduli);
    }
}

#[inline(always)]
fn add_moduli<T: Real>(slopes: &mut Slopes<T>, own: &[T; 2]) {
    for i in 0..2 {
        slopes.moduli[i] = slopes.moduli[i].clone() + &own[i];
    }
}

/// The slopes of one spring on content.
struct ContentSlopes<T> {
    /// In the content that it measures, and in the volumes of the two terms.
    contents: [T; 3],
    moduli: [T; 2],
}

/// `k = S/c²` and the rest content `c (1 + P/S)` with `P = μ s₀ v`, `S = P + λ s₁ w`.
#[inline(always)]
fn spring<T: Real>(
    moduli: &Moduli<T>,
    shares: [f64; 2],
    [content, volume, volumetric]: [&T; 3],
    of_constant: &T,
    of_rest: &T,
) -> ContentSlopes<T> {
    let (mu, lambda) = (moduli.mu.clone().scaled(&shares[0]), moduli.lambda.clone().scaled(&shares[1]));
    let pull = volume.clone() * &mu;
    let slope = (volumetric.clone() * &lambda) + &pull;
    let ratio = pull / &slope;
    let one = content.one();
    let square = one.clone() / &(content.clone() * content);
    // Each is that in S with P apart, and then that in P.
    let rest = of_rest.clone() * content / &slope;
    let of_slope = (of_constant.clone() * &square).minus_product(&rest, &ratio);
    let of_pull = of_slope.clone() + &rest;
    let twice = (of_constant.clone() * &slope * &square / content).scaled(&-2.0);
    let of_content = twice + &(of_rest.clone() * &(one + &ratio));
    ContentSlopes {
        moduli: [(of_slope.clone() * volumetric).scaled(&shares[1]), (of_pull.clone() * volume).scaled(&shares[0])],
        contents: [of_content, of_pull * &mu, of_slope * &lambda],
    }
}
