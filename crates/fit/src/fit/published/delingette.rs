//! Delingette (2008): triangles and tetrahedra whose edges are coupled; exact for linear membranes and solids.
//!
//! With y_e the change of the squared length of edge e, Green's strain is `E = Σ_e y_e T_e` with `T_e = −½ sym(g_a ⊗ g_b)`, where a and b are the
//! ends of e and g the gradients of the shape functions: a linear function has the squared stretch `Σ_ab x_a·x_b g_a ⊗ g_b`, and the g add up
//! to zero. The energy `V (λ/2 (tr E)² + G tr E²)` is therefore `Σ_ef k_ef/4 y_e y_f` with the stiffness
//! `k_ef = V/2 (λ G_ab G_cd + G (G_ac G_bd + G_ad G_bc))`, `G_ab = g_a·g_b`, in J/m⁴: tensile for e = f, else angular. On triangles, with A the
//! area at rest, `c_i` the cotangent of the angle opposite edge i, and μ twice the shear modulus G, it is `k_i = (2 c_i² (λ + μ) + μ)/(16 A)` and
//! `k_ij = (2 c_i c_j (λ + μ) − μ)/(16 A)`.
//!
//! The product of two elongations is `x y = ½ ((x + y)² − x² − y²)`. Couplings are therefore springs on sums of two
//! measures, whose constants are subtracted from those of the two edges.

use super::cell_shape::{CellShape, Elasticity};
use super::quantity::Quantity;

/// Quadratic springs: the edges, and then their [`couples`]. The energy is
/// `W = Σ_i l_i² k_i (Δl_i)² + Σ_ij 2 l_i l_j k_ij Δl_i Δl_j`; constants in N/m. Their stiffness at rest is that of the
/// finite element.
pub fn quadratic<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    let l = &cell.lengths;
    coupled(cell, bulk, k, |i, j, stiffness| l[i].clone() * 2.0 * l[j].clone() * stiffness);
}

/// Biquadratic springs: the squared edges, and then the sums of two of them. The energy is
/// `W = Σ_i k_i/4 (Δl_i²)² + Σ_ij k_ij/2 Δl_i² Δl_j²`, constants in J/m⁴. It is equal to the Saint-Venant–Kirchhoff
/// energy `V (λ/2 (tr E)² + G tr E²)` with Green's strain E, however large the strain is.
pub fn biquadratic<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    coupled(cell, bulk, k, |_, _, stiffness| stiffness * 0.5);
}

/// The two edges of each coupling between so many edges.
pub fn couples(edges: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..edges).flat_map(move |i| (i + 1..edges).map(move |j| [i, j]))
}

/// Writes springs with the energy `½ Σ_i s_ii k_i x_i² + Σ_ij s_ij k_ij x_i x_j`.
fn coupled<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T], scaled: impl Fn(usize, usize, T) -> T) {
    let edges = cell.pairs.len();
    let stiffness = if cell.dimension == 2 { triangle(cell, bulk) } else { tetrahedron(cell, bulk) };
    let at = |i: usize, j: usize| stiffness[i * edges + j].clone();
    let (tensile, angular) = k.split_at_mut(edges);
    tensile.iter_mut().enumerate().for_each(|(i, k)| *k = scaled(i, i, at(i, i)));
    for (k, [i, j]) in angular.iter_mut().zip(couples(edges)) {
        *k = scaled(i, j, at(i, j));
        tensile[i] = tensile[i].clone() - k.clone();
        tensile[j] = tensile[j].clone() - k.clone();
    }
}

/// The tensile and angular stiffness of the edges of a triangle, `[edges × edges]`, J/m⁴.
fn triangle<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>) -> Vec<T> {
    // The paper writes the law with twice the shear modulus.
    let (lambda, mu, area) = (bulk.moduli.lambda.clone(), bulk.moduli.mu.clone() * 2.0, cell.content.clone());
    let squares: Vec<T> = cell.lengths.iter().map(|l| l.clone() * l.clone()).collect();
    let Some(total) = squares.iter().cloned().reduce(|sum, square| sum + square) else { return Vec::new() };
    let cotangent: Vec<T> =
        squares.iter().map(|l2| (total.clone() - l2.clone() * 2.0) / (area.clone() * 4.0)).collect();
    let edges = cotangent.len();
    let stiffness = |e: usize| {
        let (i, j) = (e / edges, e % edges);
        let sign = if i == j { 1.0 } else { -1.0 };
        let both = cotangent[i].clone() * 2.0 * cotangent[j].clone();
        (both * (lambda.clone() + mu.clone()) + mu.clone() * sign) / (area.clone() * 16.0)
    };
    (0..edges * edges).map(stiffness).collect()
}

/// The tensile and angular stiffness of the edges of a tetrahedron, `[edges × edges]`, J/m⁴. The `G_ab` of nodes 1 to 3 are the inverse of
/// the products `M_ab = (l_0a² + l_0b² − l_ab²)/2` of the edges at node 0, with `det M = 36 V²`.
fn tetrahedron<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>) -> Vec<T> {
    let square = |a: usize, b: usize| {
        let place = cell.pairs.iter().position(|pair| *pair == [a, b] || *pair == [b, a]).unwrap_or(0);
        // All six edges of a tetrahedron are among the pairs, so that each one is found.
        cell.lengths[place].clone() * cell.lengths[place].clone()
    };
    let product = |a: usize, b: usize| match a == b {
        true => square(0, a + 1),
        false => (square(0, a + 1) + square(0, b + 1) - square(a + 1, b + 1)) / 2.0,
    };
    let m: Vec<T> = (0..9).map(|e| product(e / 3, e % 3)).collect();
    let determinant = cell.content.clone() * cell.content.clone() * 36.0;
    let cofactor = |a: usize, b: usize| {
        let [i, j] = [(a + 1) % 3, (a + 2) % 3];
        let [k, l] = [(b + 1) % 3, (b + 2) % 3];
        let minor = m[3 * i + k].clone() * m[3 * j + l].clone() - m[3 * i + l].clone() * m[3 * j + k].clone();
        minor / determinant.clone()
    };
    // Row and column 0 from Σ_a g_a = 0.
    // A zero of the kind of number, which formulas have no other way to.
    let mut g: Vec<T> = vec![determinant.clone() * 0.0; 16];
    for a in 1..4 {
        for b in 1..4 {
            g[4 * a + b] = cofactor(a - 1, b - 1);
            g[4 * a] = g[4 * a].clone() - g[4 * a + b].clone();
        }
        g[a] = g[4 * a].clone();
        g[0] = g[0].clone() - g[a].clone();
    }
    let edges = cell.pairs.len();
    let stiffness = |e: usize| {
        let ([a, b], [c, d]) = (cell.pairs[e / edges], cell.pairs[e % edges]);
        let at = |a: usize, b: usize| g[4 * a + b].clone();
        let volumetric = bulk.moduli.lambda.clone() * at(a, b) * at(c, d);
        let shear = bulk.moduli.mu.clone() * (at(a, c) * at(b, d) + at(a, d) * at(b, c));
        (volumetric + shear) * cell.content.clone() / 2.0
    };
    (0..edges * edges).map(stiffness).collect()
}
