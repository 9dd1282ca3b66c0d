//! The tensors of a network: affine, with a strained boundary, of a period, of a part.

use super::response::{Response, respond};
use crate::analysis::tensor::basis;
use crate::error::Result;
use crate::model::{Elastic, Entries, Specimen, Support, stiffness_product};
use faer::sparse::Triplet;
use nalgebra::DMatrix;

/// The displacements `u = ε x` of the unit strains of Kelvin's notation, `[points · dimension × strains]`, m, relative to the first point, so
/// that bodies far from the origin lose no digits.
fn strained(points: &[f64], d: usize) -> DMatrix<f64> {
    let strains = basis(d);
    DMatrix::from_fn(points.len(), strains.len(), |dof, case| {
        (0..d).map(|l| strains[case][(dof % d, l)] * (points[dof - dof % d + l] - points[l])).sum()
    })
}

/// C where all points follow the strain: `Uᵀ K U/V`, Kelvin's notation, Pa. It bounds the stiffness from above (Voigt).
pub fn affine(specimen: &Specimen, volume: f64) -> DMatrix<f64> {
    let d = specimen.network.dimension;
    let u = strained(&specimen.points, d);
    let k = specimen.network.stiffness(&specimen.points);
    u.tr_mul(&stiffness_product(&k, &u)) / volume
}

/// C where the points of the boundary follow the strain and the others find their equilibrium, Pa; and whether these are stable.
///
/// # Errors
/// The stiffness does not fit into memory, or some points find no equilibrium.
pub fn of_body(specimen: &Specimen, boundary: &[bool], volume: f64) -> Result<(DMatrix<f64>, bool)> {
    let d = specimen.network.dimension;
    specimen.network.check_size()?;
    let k = specimen.network.stiffness(&specimen.points);
    let prescribed = boundary.iter().flat_map(|held| std::iter::repeat_n(held.then_some(0.0), d)).collect();
    relaxed(&k, &Support { prescribed }, (&specimen.points, d), &strained(&specimen.points, d), volume)
}

/// C of a network that repeats itself: every point is free but for the strain of its period, Pa; and whether the points are stable. Motions
/// of the points without resistance change nothing.
///
/// # Errors
/// The stiffness does not fit into memory, or some points find no equilibrium.
pub fn of_period(specimen: &Specimen, volume: f64) -> Result<(DMatrix<f64>, bool)> {
    specimen.network.check_size()?;
    let k = specimen.network.stiffness(&specimen.points);
    period_tensor(&k, (&specimen.points, specimen.network.dimension), |p| specimen.owner(p), specimen.count(), volume)
}

/// [`of_period`] of any stiffness K: `owner` is the own point of a point, and the first `count` points are own ones.
///
/// # Errors
/// This returns the errors of [`of_period`].
pub fn period_tensor(
    k: &Entries,
    (points, d): (&[f64], usize),
    owner: impl Fn(usize) -> usize,
    count: usize,
    volume: f64,
) -> Result<(DMatrix<f64>, bool)> {
    let u = strained(points, d);
    let forces = stiffness_product(k, &u);
    let affine = u.tr_mul(&forces);
    let own = |dof: usize| owner(dof / d) * d + dof % d;
    let mut folded = DMatrix::zeros(count * d, u.ncols());
    for (dof, row) in forces.row_iter().enumerate() {
        // The force on a point and those on its images are forces on one point.
        (0..u.ncols()).for_each(|case| folded[(own(dof), case)] += row[case]);
    }
    let inner = folded_entries(k, own);
    let support = Support { prescribed: vec![None; count * d] };
    let at = (&points[..count * d], d);
    let Response { displacements, is_stable } = respond(&inner, &support, at, &folded, forces.norm())?;
    Ok(((affine - folded.tr_mul(&displacements)) / volume, is_stable))
}

/// The stiffness of the own points of a network that repeats itself: images move with them.
pub fn folded_entries(entries: &Entries, own: impl Fn(usize) -> usize) -> Entries {
    let mut folded = Entries::with_capacity(entries.len());
    for e in entries {
        let (row, column) = (own(e.row), own(e.col));
        // An entry off the diagonal stands for two, which meet where two images are of one point.
        let value = if e.row != e.col && row == column { 2.0 * e.val } else { e.val };
        folded.push(Triplet::new(row.max(column), row.min(column), value));
    }
    folded
}

/// C of a part of a network, Pa, where all points follow the strain: a spring belongs to its points in equal shares, and only the shares of
/// the points of the part count. At its border it has half of the springs that cross it.
pub fn of_points(specimen: &Specimen, part: &[bool], volume: f64) -> DMatrix<f64> {
    let share = |points: &[usize]| {
        let inside = points.iter().filter(|&&p| part[specimen.owner(p)]).count();
        // Equal shares add up to one over all parts, so that their mean is the tensor of the whole.
        inside as f64 / points.len() as f64
    };
    let lengths = specimen.network.lengths.iter().map(|spring| share(&spring.points));
    let others = specimen.network.others.iter().map(|spring| share(&spring.points));
    let shares: Vec<f64> = lengths.chain(others).collect();
    let own = Specimen { network: specimen.network.scaled(&shares), ..specimen.clone() };
    affine(&own, volume)
}

fn relaxed(
    k: &Entries,
    support: &Support,
    at: (&[f64], usize),
    u: &DMatrix<f64>,
    volume: f64,
) -> Result<(DMatrix<f64>, bool)> {
    let forces = stiffness_product(k, u);
    let affine = u.tr_mul(&forces);
    let Response { displacements, is_stable } = respond(k, support, at, &forces, forces.norm())?;
    Ok(((affine - forces.tr_mul(&displacements)) / volume, is_stable))
}

/// The forces of the springs on the own points, `[points · dimension]`, N; `None` where a spring has no force.
pub(super) fn forces(specimen: &Specimen) -> Option<Vec<f64>> {
    let mut forces = vec![0.0; specimen.points.len()];
    specimen.network.forces(&specimen.points, &mut forces).then_some(forces)
}
