//! Normal equations of the plain Frobenius fit, `min_k ‖R − Σ_s k_s g_s g_sᵀ‖_F`:
//! `M_st = (g_s·g_t)²`, `b_s = g_sᵀ R g_s`. Natsupakpong and Çavuşoğlu (2010), (23).

use super::normal::Normal;
use crate::material::Moduli;
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// Fills in `M` and `b` of the element with nodes at `x`. Neither R nor any `g gᵀ` is formed, and length springs need
/// no square root: with d = x_j − x_i, `n nᵀ = d dᵀ/‖d‖²`.
pub fn normal_equations(springs: &Springs, x: &[f64], geometry: &Geometry, moduli: Moduli, normal: &mut Normal) {
    match springs.dimension {
        2 => lengths::<2>(springs, x, geometry, moduli, normal),
        _ => lengths::<3>(springs, x, geometry, moduli, normal),
    }
    if springs.content.is_some() {
        content(springs, x, geometry, moduli, normal);
    }
}

fn lengths<const D: usize>(springs: &Springs, x: &[f64], geometry: &Geometry, moduli: Moduli, normal: &mut Normal) {
    let (m, n) = (springs.len(), springs.nodes);
    normal.resize(m);
    let x = x.as_chunks::<D>().0;
    let d = |&[i, j]: &[usize; 2]| -> [f64; D] { std::array::from_fn(|k| x[j][k] - x[i][k]) };
    let grad = geometry.gradients.as_chunks::<D>().0;
    normal.gram.fill(0.0);
    for (s, pair) in springs.pairs.iter().enumerate() {
        let ds = d(pair);
        let square = dot(&ds, &ds);
        let [i, j] = *pair;
        let mut energy = 0.0;
        for (grad, v) in grad.chunks_exact(n).zip(&geometry.volumes) {
            // ε = sym(n wᵀ), w = ∇N_j − ∇N_i: εᵀDε = λ (n·w)² + μ (w·w + (n·w)²)
            let w: [f64; D] = std::array::from_fn(|k| grad[j][k] - grad[i][k]);
            let (dw, ww) = (dot(&ds, &w), dot(&w, &w));
            energy += v * ((moduli.lambda + moduli.mu) * dw * dw + moduli.mu * square * ww);
        }
        normal.rhs[s] = energy / square;
        normal.gram[s * m + s] = square;
    }
    for &(s, t, _) in &springs.touching {
        let cosine = dot(&d(&springs.pairs[s]), &d(&springs.pairs[t]));
        let square = cosine * cosine / (normal.gram[s * m + s] * normal.gram[t * m + t]);
        normal.gram[s * m + t] = square;
        normal.gram[t * m + s] = square;
    }
    for s in 0..springs.pairs.len() {
        normal.gram[s * m + s] = 4.0;
    }
}

/// The last row and column: the spring on the cell's content.
fn content(springs: &Springs, x: &[f64], geometry: &Geometry, moduli: Moduli, normal: &mut Normal) {
    let (m, d) = (springs.len(), springs.dimension);
    let last = m - 1;
    let c = geometry.content_gradient();
    for (s, &[i, j]) in springs.pairs.iter().enumerate() {
        let (mut along, mut square) = (0.0, 0.0);
        for k in 0..d {
            let edge = x[j * d + k] - x[i * d + k];
            along += edge * (c[j * d + k] - c[i * d + k]);
            square += edge * edge;
        }
        normal.gram[s * m + last] = along * along / square;
        normal.gram[last * m + s] = along * along / square;
    }
    let cc: f64 = c.iter().map(|c| c * c).sum();
    normal.gram[last * m + last] = cc * cc;
    normal.rhs[last] = geometry.energy(moduli, &c);
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}
