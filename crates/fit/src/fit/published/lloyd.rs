//! Lloyd, Székely and Harders (2007): constants of regular cells, and forces that preserve their content.

use super::cell_shape::{CellShape, Elasticity};
use super::corners::Joint;
use super::quantity::Quantity;

/// Equilateral triangle: `k = √3/4 E`, exact at ν = 1/3, in N/m.
pub fn triangle<T: Quantity>(bulk: &Elasticity<T>, k: &mut [T]) {
    k.fill(bulk.young.clone() * (3f64.sqrt() / 4.0));
}

/// Square at ν = 1/3: `k = 5/16 E` for the edges and `7/16 E` for the diagonals, in N/m.
pub fn quadrilateral<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    for (k, &pair) in k.iter_mut().zip(cell.pairs) {
        let part = if cell.corners.joint(pair) == Some(Joint::Edge) { 5.0 } else { 7.0 };
        *k = bulk.young.clone() * (part / 16.0);
    }
}

/// Regular tetrahedron at ν = 1/4: `k = 2√2/25 E l`, in N/m, with `l = (12 V/√2)^⅓` the edge of the regular tetrahedron
/// of the same volume.
pub fn tetrahedron<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    let edge = (cell.content.clone() * (12.0 / 2f64.sqrt())).cube_root();
    k.fill(bulk.young.clone() * (2.0 * 2f64.sqrt() / 25.0) * edge);
}

/// The constant κ/V of a spring on the content V, with the energy `κ (V − V₀)²/(2 V₀)`; for an area in N/m³, for a
/// volume in N/m⁵.
///
/// `κ = K(ν) − K(ν₀)`, with `K = E/(d (1 − (d − 1) ν))` the bulk modulus in d dimensions: the excess over the bulk
/// modulus at the ratio ν₀ = 1/(d + 1) for which the other springs are made. The form is that of the paper's penalty
/// forces; the size is derived here. Triangles and squares, whose springs have K(ν₀), then resist a change of their
/// area as the material does.
pub fn preserving<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>) -> T {
    let (d, nu) = (cell.dimension as f64, bulk.poisson.clone());
    let excess = (nu.clone() + -1.0 / (d + 1.0)).positive_part();
    let kappa = bulk.young.clone() * (d - 1.0) * excess * (d + 1.0) / ((nu * (1.0 - d) + 1.0) * (2.0 * d));
    kappa / cell.content.clone()
}
