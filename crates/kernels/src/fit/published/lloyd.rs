//! Lloyd, Székely and Harders (2007): constants of regular cells, and forces that preserve their content.

use super::cell_shape::{CellShape, Elasticity};
use super::corners::Joint;

/// `k = √3/4 E` of an equilateral triangle, exact at ν = 1/3, N/m.
pub fn triangle(bulk: &Elasticity, k: &mut [f64]) {
    k.fill(3f64.sqrt() / 4.0 * bulk.young);
}

/// `k = 5/16 E` of the edges and `7/16 E` of the diagonals of a square at ν = 1/3, N/m.
pub fn quadrilateral(cell: &CellShape, bulk: &Elasticity, k: &mut [f64]) {
    for (k, &pair) in k.iter_mut().zip(cell.pairs) {
        let part = if cell.corners.joint(pair) == Some(Joint::Edge) { 5.0 } else { 7.0 };
        *k = part / 16.0 * bulk.young;
    }
}

/// `k = 2√2/25 E l` of a regular tetrahedron at ν = 1/4, l the edge of the one of the same volume, `(12 V/√2)^⅓`, N/m.
pub fn tetrahedron(cell: &CellShape, bulk: &Elasticity, k: &mut [f64]) {
    let edge = (12.0 / 2f64.sqrt() * cell.content).cbrt();
    k.fill(2.0 * 2f64.sqrt() / 25.0 * bulk.young * edge);
}

/// The constant κ/V of a spring on the content V, with the energy `κ (V − V₀)²/(2 V₀)`; of an area N/m³, of a volume N/m⁵.
///
/// `κ = K(ν) − K(ν₀)`, `K = E/(d (1 − (d − 1) ν))` the bulk modulus in d dimensions: what the material has more than at
/// the ratio ν₀ = 1/(d + 1) that the other springs are made for. The form is that of the paper's penalty
/// forces, the size is derived here: triangles and squares, whose springs have K(ν₀), resist a change of their area as the material does.
pub fn preserving(cell: &CellShape, bulk: &Elasticity) -> f64 {
    let (d, nu) = (cell.dimension as f64, bulk.poisson);
    let excess = (nu - 1.0 / (d + 1.0)).max(0.0);
    let kappa = bulk.young * (d - 1.0) * excess * (d + 1.0) / (2.0 * d * (1.0 - (d - 1.0) * nu));
    kappa / cell.content
}
