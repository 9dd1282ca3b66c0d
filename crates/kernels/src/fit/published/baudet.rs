//! Baudet, Beuve, Jaillet, Shariat and Zara (2007, 2009): rectangles and cubes with springs along edges and diagonals.
//!
//! Stretched by ε along one axis and by −ν ε across, the springs answer with the stress E ε along the axis and with
//! `E ε (1 − (d + 1) ν)/2` across it, which should be zero: the correction has to cancel that. Alone, with nothing holding
//! them across, the springs of a lattice have in the plane `E (3 + 9ν)/(4 + 6ν)` and `1/(2 + 3ν)` for E and ν, and below
//! ν = −1/(d + 1) they do not stand. A body of cubes that nothing holds has three motions besides the rigid ones that no
//! spring resists, and none if a side is held.

use super::cell_shape::{CellShape, Elasticity};
use super::corners::Joint;

/// Of a rectangle with sides l and h: `k_d = E (l² + h²)/(4 l h (1 + ν))` of the diagonals and
/// `k_l = E (h² (3ν + 2) − l²)/(4 l h (1 + ν))` of the sides l, N/m. Sides beyond `l = h √(3ν + 2)` are below zero.
pub fn rectangle(cell: &CellShape, bulk: &Elasticity, k: &mut [f64]) {
    let (e, nu) = (bulk.young, bulk.poisson);
    let sides = cell.extents();
    let (l, h) = (sides[0], sides[1]);
    let unit = e / (4.0 * l * h * (1.0 + nu));
    for (k, &pair) in k.iter_mut().zip(cell.pairs) {
        *k = match cell.corners.direction(pair).filter(|_| cell.corners.joint(pair) == Some(Joint::Edge)) {
            Some(0) => unit * (h * h * (3.0 * nu + 2.0) - l * l),
            Some(_) => unit * (l * l * (3.0 * nu + 2.0) - h * h),
            None => unit * (l * l + h * h),
        };
    }
}

/// Of a cube, a the side of the one of the same volume: `E a (4ν + 1)/(8 (1 + ν))` of the edges and
/// `3 E a/(8 (1 + ν))` of the diagonals through the inside, N/m.
pub fn cube(cell: &CellShape, bulk: &Elasticity, k: &mut [f64]) {
    let unit = bulk.young * cell.content.cbrt() / (8.0 * (1.0 + bulk.poisson));
    for (k, &pair) in k.iter_mut().zip(cell.pairs) {
        let edge = cell.corners.joint(pair) == Some(Joint::Edge);
        *k = unit * if edge { 4.0 * bulk.poisson + 1.0 } else { 3.0 };
    }
}

/// The correction: constants of the springs on the distance between opposite sides, in the order of the directions, and
/// last of that on the content; N/m, and N/m³ or N/m⁵.
///
/// A symmetric force linear in the strains ε_i along the axes has the energy density `½ (a − b) Σ ε_i² + ½ b (Σ ε_i)²`.
/// It adds no stress along the axis of a tension and cancels the rest across it where `a = (d − 1) ν b` and
/// `b = E ((d + 1) ν − 1)/(2 (1 + ν) (1 − (d − 1) ν))`. The papers state a force orthogonal to a known tension; its
/// direction and purpose are theirs, its size is derived here, and no load has to be known.
pub fn correction(cell: &CellShape, bulk: &Elasticity, k: &mut [f64]) {
    let (d, nu) = (cell.dimension as f64, bulk.poisson);
    let difference = -bulk.young * ((d + 1.0) * nu - 1.0) / (2.0 * (1.0 + nu));
    let (each, content) = k.split_at_mut(cell.dimension);
    let sides = cell.extents();
    each.iter_mut().zip(sides).for_each(|(k, side)| *k = difference * cell.content / (side * side));
    content.fill(-difference / ((1.0 - (d - 1.0) * nu) * cell.content));
}
