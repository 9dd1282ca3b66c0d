//! Delingette (2008): triangles whose edges are coupled by their angles, exact for linear membranes.
//!
//! With A the area at rest, `c_i` the cotangent of the angle opposite edge i, and μ twice the shear modulus, the tensile
//! stiffness of edge i is `k_i = (2 c_i² (λ + μ) + μ)/(16 A)` and the angular one of the edges i and j
//! `k_ij = (2 c_i c_j (λ + μ) − μ)/(16 A)`, J/m⁴.
//!
//! A product of two elongations is `x y = ½ ((x + y)² − x² − y²)`, so that couplings are springs on sums of two
//! measures, and each takes its constant from the springs of its two edges.

use super::cell_shape::{CellShape, Elasticity};

/// Of the edges and then of [`couples`] of them: triangular quadratic springs,
/// `W = Σ_i l_i² k_i (Δl_i)² + Σ_ij 2 l_i l_j k_ij Δl_i Δl_j`, N/m. Their stiffness at rest is that of the finite
/// element.
pub fn quadratic(cell: &CellShape, bulk: &Elasticity, k: &mut [f64]) {
    let l = &cell.lengths;
    coupled(cell, bulk, k, |i, j| 2.0 * l[i] * l[j]);
}

/// Of the squared edges and then of the sums of two: triangular biquadratic springs,
/// `W = Σ_i k_i/4 (Δl_i²)² + Σ_ij k_ij/2 Δl_i² Δl_j²`, J/m⁴: the energy `A (λ/2 (tr E)² + G tr E²)` of Saint-Venant and
/// Kirchhoff with Green's strain E, however large it is.
pub fn biquadratic(cell: &CellShape, bulk: &Elasticity, k: &mut [f64]) {
    coupled(cell, bulk, k, |_, _| 0.5);
}

/// The two edges of each coupling of so many edges.
pub fn couples(edges: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..edges).flat_map(move |i| (i + 1..edges).map(move |j| [i, j]))
}

/// Springs of the energy `½ Σ_i s_ii k_i x_i² + Σ_ij s_ij k_ij x_i x_j`.
fn coupled(cell: &CellShape, bulk: &Elasticity, k: &mut [f64], scale: impl Fn(usize, usize) -> f64) {
    let (lambda, mu, area) = (bulk.moduli.lambda, 2.0 * bulk.moduli.mu, cell.content);
    let total: f64 = cell.lengths.iter().map(|l| l * l).sum();
    let cotangent: Vec<f64> = cell.lengths.iter().map(|l| (total - 2.0 * l * l) / (4.0 * area)).collect();
    let stiffness = |i: usize, j: usize| {
        let sign = if i == j { 1.0 } else { -1.0 };
        (2.0 * cotangent[i] * cotangent[j] * (lambda + mu) + sign * mu) / (16.0 * area)
    };
    let edges = cotangent.len();
    let (tensile, angular) = k.split_at_mut(edges);
    tensile.iter_mut().enumerate().for_each(|(i, k)| *k = scale(i, i) * stiffness(i, i));
    for (k, [i, j]) in angular.iter_mut().zip(couples(edges)) {
        *k = scale(i, j) * stiffness(i, j);
        tensile[i] -= *k;
        tensile[j] -= *k;
    }
}
