//! Baudet, Beuve, Jaillet, Shariat and Zara (2007, 2009): rectangles and cubes with springs along edges and diagonals.
//!
//! If the cell is stretched by ε along one axis and by −ν ε across it, the springs answer with the stress E ε along the
//! axis and with `E ε (1 − (d + 1) ν)/2` across it, which should be zero: the correction cancels this. Without the
//! correction and without lateral constraint, the springs of a lattice in the plane have Young's modulus
//! `E (3 + 9ν)/(4 + 6ν)` and Poisson's ratio `1/(2 + 3ν)`; below ν = −1/(d + 1) they are indefinite. A free body of
//! cubes has three motions besides the rigid ones that no spring resists, and none if one side is held.

use super::cell_shape::{CellShape, Elasticity};
use super::corners::Joint;
use super::quantity::Quantity;

/// Rectangle with sides l and h: `k_d = E (l² + h²)/(4 l h (1 + ν))` for the diagonals and
/// `k_l = E (h² (3ν + 2) − l²)/(4 l h (1 + ν))` for the sides l, in N/m. Sides longer than `l = h √(3ν + 2)` have
/// negative constants.
pub fn rectangle<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    let (e, nu) = (bulk.young.clone(), bulk.poisson.clone());
    let sides = cell.extents();
    let (l, h) = (sides[0].clone(), sides[1].clone());
    let (l2, h2) = (l.clone() * l.clone(), h.clone() * h.clone());
    let unit = e / (l * 4.0 * h * (nu.clone() + 1.0));
    let wide = nu * 3.0 + 2.0;
    for (k, &pair) in k.iter_mut().zip(cell.pairs) {
        *k = match cell.corners.direction(pair).filter(|_| cell.corners.joint(pair) == Some(Joint::Edge)) {
            Some(0) => unit.clone() * (h2.clone() * wide.clone() - l2.clone()),
            Some(_) => unit.clone() * (l2.clone() * wide.clone() - h2.clone()),
            None => unit.clone() * (l2.clone() + h2.clone()),
        };
    }
}

/// Cube, with a the side of the cube of the same volume: `E a (4ν + 1)/(8 (1 + ν))` for the edges and
/// `3 E a/(8 (1 + ν))` for the space diagonals, in N/m.
pub fn cube<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    let nu = bulk.poisson.clone();
    let unit = bulk.young.clone() * cell.content.clone().cube_root() / ((nu.clone() + 1.0) * 8.0);
    for (k, &pair) in k.iter_mut().zip(cell.pairs) {
        let edge = cell.corners.joint(pair) == Some(Joint::Edge);
        *k = if edge { unit.clone() * (nu.clone() * 4.0 + 1.0) } else { unit.clone() * 3.0 };
    }
}

/// The correction: the constants of the springs on the distances between opposite sides, in the order of the
/// directions, in N/m; and last that of the spring on the content, in N/m³ or N/m⁵.
///
/// A symmetric force that is linear in the strains ε_i along the axes has the energy density
/// `½ (a − b) Σ ε_i² + ½ b (Σ ε_i)²`. It adds no stress along the axis of a tension and cancels the stress across it if
/// `a = (d − 1) ν b` and `b = E ((d + 1) ν − 1)/(2 (1 + ν) (1 − (d − 1) ν))`. The papers state a force orthogonal to a
/// known tension. Its direction and purpose are theirs; its size is derived here, and no load has to be known.
pub fn correction<T: Quantity>(cell: &CellShape<T>, bulk: &Elasticity<T>, k: &mut [T]) {
    let (d, nu) = (cell.dimension as f64, bulk.poisson.clone());
    let difference = bulk.young.clone() * -1.0 * (nu.clone() * (d + 1.0) + -1.0) / ((nu.clone() + 1.0) * 2.0);
    let (each, content) = k.split_at_mut(cell.dimension);
    let sides = cell.extents();
    let along = |(k, side): (&mut T, T)| *k = difference.clone() * cell.content.clone() / (side.clone() * side);
    each.iter_mut().zip(sides).for_each(along);
    content.fill(difference.clone() * -1.0 / ((nu * (1.0 - d) + 1.0) * cell.content.clone()));
}
