//! The elasticity tensor of a piece of a network with a strained boundary.

use super::isotropic::basis;
use super::piece::{PatchSpring, Piece};
use super::sample::Sample;
use crate::material::{CellMap, Hooke};
use crate::model::{Entries, content, finite_elements};
use nalgebra::{DMatrix, DVector};

/// C of a sample, `[strains × strains]`, Pa, from the energies `V/2 ε : C : ε` under `u = ε x` of all points except
/// those inside the sample, which are in equilibrium; in the plane multiplied by the thickness, for a rod by its
/// cross-section.
///
/// ```text
/// V C = Uᵀ K_s U − Fᵀ K_ii⁻¹ F,    F = K_i U
/// ```
///
/// U are the unit strains of [`basis`] at the points. K_s is the stiffness of the sample's share of each spring; K_i
/// and K_ii are the rows of the points inside, in whose equations every spring has its whole force. All contain the
/// geometric stiffness of springs that pull at rest. The columns of `frame`, `[space × dimension of the cells]`, are
/// orthonormal: for flat samples in space only motions in their plane count.
pub(super) fn tensor(sample: &Sample, piece: &Piece, frame: &DMatrix<f64>) -> DMatrix<f64> {
    let entries = piece.network.stiffness(&piece.points);
    let is_whole = piece.shares.iter().all(|share| *share == 1.0);
    let own = (!is_whole).then(|| piece.network.scaled(&piece.shares).stiffness(&piece.points));
    relaxed(sample, &piece.points, (&entries, own.as_ref().unwrap_or(&entries)), &piece.patches, frame)
}

/// C of the finite elements of a sample, as [`tensor`] has it of a network.
pub(super) fn body_tensor(sample: &Sample, moduli: CellMap<Hooke>, frame: &DMatrix<f64>) -> DMatrix<f64> {
    let entries = finite_elements(&sample.mesh, moduli);
    relaxed(sample, &sample.mesh.points, (&entries, &entries), &[], frame)
}

/// C from the stiffness of all that acts on the points inside, and from the share of it that belongs to the sample.
fn relaxed(
    sample: &Sample,
    points: &[f64],
    (entries, own): (&Entries, &Entries),
    patches: &[PatchSpring],
    frame: &DMatrix<f64>,
) -> DMatrix<f64> {
    let (space, d) = (sample.mesh.dimension, frame.ncols());
    let basis = basis(d);
    // Relative to one of its own points, so that bodies far from the origin lose no digits.
    let x = DMatrix::from_fn(space, points.len() / space, |k, p| points[p * space + k] - points[k]);
    let volume = content(&sample.mesh);
    let strained: Vec<DVector<f64>> = basis
        .iter()
        .map(|strain| {
            let u = frame * strain * frame.transpose() * &x;
            DVector::from_column_slice(u.as_slice())
        })
        .collect();
    let strained = DMatrix::from_columns(&strained);
    let mut forces = product(entries, &strained);
    let mut affine = match std::ptr::eq(entries, own) {
        true => strained.tr_mul(&forces),
        false => strained.tr_mul(&product(own, &strained)),
    };
    let mut place = vec![usize::MAX; points.len() / space];
    sample.interior.iter().enumerate().for_each(|(i, &point)| place[point] = i);
    let count = sample.interior.len();
    let mut inner = DMatrix::zeros(count * space, count * space);
    for entry in entries {
        let (i, j) = (place[entry.row / space], place[entry.col / space]);
        if i != usize::MAX && j != usize::MAX {
            let (i, j) = (i * space + entry.row % space, j * space + entry.col % space);
            inner[(i, j)] += entry.val;
            if entry.row != entry.col {
                inner[(j, i)] += entry.val;
            }
        }
    }
    for PatchSpring { points, gradient, slope, share } in patches {
        let dofs: Vec<usize> = points.iter().flat_map(|&point| point * space..(point + 1) * space).collect();
        let along = |case: usize| dofs.iter().zip(gradient).map(|(&dof, g)| g * strained[(dof, case)]).sum::<f64>();
        let stretch = DVector::from_fn(basis.len(), |case, _| along(case));
        affine.ger(share * slope, &stretch, &stretch, 1.0);
        for (&row, g) in dofs.iter().zip(gradient) {
            (0..basis.len()).for_each(|case| forces[(row, case)] += slope * g * stretch[case]);
        }
        let own = dofs.iter().zip(gradient).filter(|(dof, _)| place[**dof / space] != usize::MAX);
        let own: Vec<(usize, f64)> = own.map(|(dof, g)| (place[dof / space] * space + dof % space, *g)).collect();
        for &(i, gi) in &own {
            own.iter().for_each(|&(j, gj)| inner[(i, j)] += slope * gi * gj);
        }
    }
    let force = DMatrix::from_fn(count * space, basis.len(), |row, case| {
        forces[(sample.interior[row / space] * space + row % space, case)]
    });
    let (inner, force) = in_frame(inner, force, frame);
    (affine - force.tr_mul(&solve(inner, &force))) / volume
}

/// The parts in the directions of the frame.
fn in_frame(inner: DMatrix<f64>, force: DMatrix<f64>, frame: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
    let (space, d) = frame.shape();
    if space == d {
        return (inner, force);
    }
    let count = inner.nrows() / space;
    let mut q = DMatrix::zeros(count * space, count * d);
    (0..count).for_each(|i| q.view_mut((i * space, i * d), (space, d)).copy_from(frame));
    (q.tr_mul(&(inner * &q)), q.tr_mul(&force))
}

/// `K⁻¹ F`; zero for motions without stiffness.
fn solve(inner: DMatrix<f64>, force: &DMatrix<f64>) -> DMatrix<f64> {
    if let Some(factor) = inner.clone().cholesky() {
        return factor.solve(force);
    }
    if !inner.iter().all(|k| k.is_finite()) {
        return force * f64::NAN;
    }
    let eigen = inner.symmetric_eigen();
    let floor = 1e-10 * eigen.eigenvalues.amax();
    let inverse = eigen.eigenvalues.map(|e| if e.abs() > floor { 1.0 / e } else { 0.0 });
    &eigen.eigenvectors * DMatrix::from_diagonal(&inverse) * eigen.eigenvectors.tr_mul(force)
}

/// `K U`.
fn product(entries: &Entries, u: &DMatrix<f64>) -> DMatrix<f64> {
    let mut y = DMatrix::zeros(u.nrows(), u.ncols());
    for entry in entries {
        for case in 0..u.ncols() {
            y[(entry.row, case)] += entry.val * u[(entry.col, case)];
            if entry.row != entry.col {
                y[(entry.col, case)] += entry.val * u[(entry.row, case)];
            }
        }
    }
    y
}
