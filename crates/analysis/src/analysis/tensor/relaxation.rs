//! The elasticity tensor of a piece of a network with a strained boundary.

use super::isotropic::basis;
use super::piece::Piece;
use super::sample::Sample;
use crate::material::{CellMap, Hooke};
use crate::model::{Entries, PatchSpring, content, finite_elements, relaxed_stiffness};
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
    relaxed_stiffness((entries, own), patches, &strained, &sample.interior, frame) / volume
}
