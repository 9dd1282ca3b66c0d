//! Van Gelder (1998): membranes of triangles, and bodies of tetrahedra.

use super::cell_shape::{CellShape, Elasticity};
use super::quantity::Quantity;

/// `k_c = E/(1 + ν) · A/c² + E ν/(1 − ν²) · (a² + b² − c²)/(8 A)`, in N/m, with c the length of the edge and a, b those
/// of the two others.
///
/// At ν = 1/3 it is equal to the constant that minimises the error of the blocks of different nodes.
pub fn triangle<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    let (e, nu, area) = (&bulk.young, &bulk.poisson, &cell.content);
    let squares: Vec<T> = cell.lengths.iter().map(|l| l.clone() * l.clone()).collect();
    let Some(total) = squares.iter().cloned().reduce(|sum, square| sum + square) else { return };
    for (k, c2) in k.iter_mut().zip(squares) {
        let along = e.clone() / (nu.clone() + 1.0) * area.clone() / c2.clone();
        let ratio = e.clone() * nu.clone() / (nu.clone() * nu.clone() * -1.0 + 1.0);
        *k = along + ratio * (total.clone() - c2 * 2.0) / (area.clone() * 8.0);
    }
}

/// `k_c = E A/c²`, the formula above at ν = 0; for a tetrahedron `E V/c²`; in N/m.
pub fn simple<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    let constant = |c: &T| bulk.young.clone() * cell.content.clone() / (c.clone() * c.clone());
    k.iter_mut().zip(&cell.lengths).for_each(|(k, c)| *k = constant(c));
}
