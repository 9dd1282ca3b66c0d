//! Normal equations of the plain Frobenius fit, `min_k ‖R − Σ_s k_s g_s g_sᵀ‖_F`:
//! `M_st = (g_s·g_t)²`, `b_s = g_sᵀ R g_s`. Natsupakpong and Çavuşoğlu (2010), (23).

use super::normal::Normal;
use crate::material::Moduli;
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// Fills in `M` and `b` of the element with nodes at `x`. Neither R nor any `g gᵀ` is formed, and length springs need
/// no square root: with d = x_j − x_i, `n nᵀ = d dᵀ/‖d‖²`.
pub fn normal_equations(springs: &Springs, x: &[f64], geometry: &Geometry, moduli: Moduli, normal: &mut Normal) {
    // As in the geometry: small sizes known at compile time.
    match (springs.dimension, springs.nodes) {
        (2, 3) => lengths::<2>(3, springs, x, geometry, moduli, normal),
        (3, 4) => lengths::<3>(4, springs, x, geometry, moduli, normal),
        (2, n) => lengths::<2>(n, springs, x, geometry, moduli, normal),
        (_, n) => lengths::<3>(n, springs, x, geometry, moduli, normal),
    }
    if springs.content.is_some() {
        content(springs, x, geometry, moduli, normal);
    }
}

#[inline(always)]
fn lengths<const D: usize>(
    n: usize,
    springs: &Springs,
    x: &[f64],
    geometry: &Geometry,
    moduli: Moduli,
    normal: &mut Normal,
) {
    let m = springs.len();
    let pairs = &springs.pairs[..];
    normal.resize(m);
    normal.edges.resize(pairs.len() * D, 0.0);
    normal.inverse_squares.resize(pairs.len(), 0.0);
    let x = &x.as_chunks::<D>().0[..n];
    let edges = normal.edges.as_chunks_mut::<D>().0;
    // d_s = x_j − x_i and 1/‖d_s‖²
    for ((d, q), &[i, j]) in edges.iter_mut().zip(&mut normal.inverse_squares).zip(pairs) {
        *d = std::array::from_fn(|k| x[j][k] - x[i][k]);
        *q = 1.0 / dot(d, d);
    }
    let edges = &*edges;
    let inverse_squares = &normal.inverse_squares[..];
    let sum = moduli.lambda + moduli.mu;
    for (point, (grad, v)) in geometry.gradients.chunks_exact(n * D).zip(&geometry.volumes).enumerate() {
        let grad = &grad.as_chunks::<D>().0[..n];
        let (along, across) = (v * sum, v * moduli.mu);
        for (((b, d), q), &[i, j]) in normal.rhs.iter_mut().zip(edges).zip(inverse_squares).zip(pairs) {
            // ε = sym(n wᵀ), w = ∇N_j − ∇N_i: εᵀDε = λ (n·w)² + μ (w·w + (n·w)²)
            let w: [f64; D] = std::array::from_fn(|k| grad[j][k] - grad[i][k]);
            let dw = dot(d, &w);
            let energy = along * dw * dw * q + across * dot(&w, &w);
            *b = if point == 0 { energy } else { *b + energy };
        }
    }
    let gram = &mut normal.gram[..m * m];
    gram.fill(0.0);
    for &(s, t) in &springs.touching {
        let cosine = dot(&edges[s], &edges[t]);
        let square = cosine * cosine * (inverse_squares[s] * inverse_squares[t]);
        gram[s * m + t] = square;
        gram[t * m + s] = square;
    }
    for s in 0..pairs.len() {
        gram[s * m + s] = 4.0;
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
