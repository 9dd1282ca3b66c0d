//! Van Gelder (1998): membranes of triangles, and bodies of tetrahedra.

use super::cell_shape::{CellShape, Elasticity};

/// `k_c = E/(1 + ν) · A/c² + E ν/(1 − ν²) · (a² + b² − c²)/(8 A)`, in N/m, with c the length of the edge and a, b those
/// of the two others.
///
/// At ν = 1/3 it is equal to the constant that minimises the error of the blocks of different nodes.
pub fn triangle(cell: &CellShape, bulk: &Elasticity, k: &mut [f64]) {
    let (e, nu) = (bulk.young, bulk.poisson);
    let total: f64 = cell.lengths.iter().map(|l| l * l).sum();
    for (k, c) in k.iter_mut().zip(&cell.lengths) {
        let c2 = c * c;
        *k = e / (1.0 + nu) * cell.content / c2 + e * nu / (1.0 - nu * nu) * (total - 2.0 * c2) / (8.0 * cell.content);
    }
}

/// `k_c = E A/c²`, the formula above at ν = 0; for a tetrahedron `E V/c²`; in N/m.
pub fn simple(cell: &CellShape, bulk: &Elasticity, k: &mut [f64]) {
    k.iter_mut().zip(&cell.lengths).for_each(|(k, c)| *k = bulk.young * cell.content / (c * c));
}
