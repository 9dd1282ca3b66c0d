//! Delingette (2008): triangles whose edges are coupled through their angles; exact for linear membranes.
//!
//! With A the area at rest, `c_i` the cotangent of the angle opposite edge i, and μ twice the shear modulus, the
//! tensile stiffness of edge i is `k_i = (2 c_i² (λ + μ) + μ)/(16 A)`, and the angular stiffness of the edges i and j
//! is `k_ij = (2 c_i c_j (λ + μ) − μ)/(16 A)`, both in J/m⁴.
//!
//! The product of two elongations is `x y = ½ ((x + y)² − x² − y²)`. Couplings are therefore springs on sums of two
//! measures, whose constants are subtracted from those of the two edges.

use super::cell_shape::{CellShape, Elasticity};
use super::quantity::Quantity;

/// Triangular quadratic springs: the edges, and then their [`couples`]. The energy is
/// `W = Σ_i l_i² k_i (Δl_i)² + Σ_ij 2 l_i l_j k_ij Δl_i Δl_j`; constants in N/m. Their stiffness at rest is that of the
/// finite element.
pub fn quadratic<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    let l = &cell.lengths;
    coupled(cell, bulk, k, |i, j, stiffness| l[i].clone() * 2.0 * l[j].clone() * stiffness);
}

/// Triangular biquadratic springs: the squared edges, and then the sums of two of them. The energy is
/// `W = Σ_i k_i/4 (Δl_i²)² + Σ_ij k_ij/2 Δl_i² Δl_j²`, constants in J/m⁴. It is equal to the Saint-Venant–Kirchhoff
/// energy `A (λ/2 (tr E)² + G tr E²)` with Green's strain E, however large the strain is.
pub fn biquadratic<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    coupled(cell, bulk, k, |_, _, stiffness| stiffness * 0.5);
}

/// The two edges of each coupling between so many edges.
pub fn couples(edges: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..edges).flat_map(move |i| (i + 1..edges).map(move |j| [i, j]))
}

/// Writes springs with the energy `½ Σ_i s_ii k_i x_i² + Σ_ij s_ij k_ij x_i x_j`.
fn coupled<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T], scaled: impl Fn(usize, usize, T) -> T) {
    let (lambda, mu, area) = (bulk.moduli.lambda.clone(), bulk.moduli.mu.clone() * 2.0, cell.content.clone());
    let squares: Vec<T> = cell.lengths.iter().map(|l| l.clone() * l.clone()).collect();
    let Some(total) = squares.iter().cloned().reduce(|sum, square| sum + square) else { return };
    let cotangent: Vec<T> =
        squares.iter().map(|l2| (total.clone() - l2.clone() * 2.0) / (area.clone() * 4.0)).collect();
    let stiffness = |i: usize, j: usize| {
        let sign = if i == j { 1.0 } else { -1.0 };
        let both = cotangent[i].clone() * 2.0 * cotangent[j].clone();
        (both * (lambda.clone() + mu.clone()) + mu.clone() * sign) / (area.clone() * 16.0)
    };
    let edges = cotangent.len();
    let (tensile, angular) = k.split_at_mut(edges);
    tensile.iter_mut().enumerate().for_each(|(i, k)| *k = scaled(i, i, stiffness(i, i)));
    for (k, [i, j]) in angular.iter_mut().zip(couples(edges)) {
        *k = scaled(i, j, stiffness(i, j));
        tensile[i] = tensile[i].clone() - k.clone();
        tensile[j] = tensile[j].clone() - k.clone();
    }
}
