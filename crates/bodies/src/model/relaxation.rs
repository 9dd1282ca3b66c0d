//! The stiffness of a body against the strains of its boundary, while the points inside find their equilibrium.

use super::Entries;
use nalgebra::{DMatrix, DVector};

/// A spring on the content of a patch of cells, which does not pull at rest: its stiffness is `k g gᵀ`.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchSpring {
    /// The points that it measures.
    pub points: Vec<usize>,
    /// The gradient g, `[points · space]`.
    pub gradient: Vec<f64>,
    /// The slope k of its force.
    pub slope: f64,
    /// The share of it in the energy.
    pub share: f64,
}

/// `Uᵀ K_s U − Fᵀ K_ii⁻¹ F` with `F = K_i U`, `[cases × cases]`.
///
/// The columns of U, `strained`, `[points · space × cases]`, are the displacements of all points, of which the `interior` ones then find
/// their equilibrium. K_s is the stiffness whose energy counts, the second of `entries`; K_i and K_ii are the rows of the interior in the
/// first, and `patches` belong to both. The columns of `frame`, `[space × directions]`, are orthonormal: the interior moves along them alone.
/// Motions of the interior without stiffness stay zero.
///
/// # Panics
/// The sizes do not agree.
pub fn relaxed_stiffness(
    (entries, own): (&Entries, &Entries),
    patches: &[PatchSpring],
    strained: &DMatrix<f64>,
    interior: &[usize],
    frame: &DMatrix<f64>,
) -> DMatrix<f64> {
    let (space, cases) = (frame.nrows(), strained.ncols());
    let mut forces = stiffness_product(entries, strained);
    // Most networks have one stiffness: its product is needed once then.
    let mut affine = match std::ptr::eq(entries, own) {
        true => strained.tr_mul(&forces),
        false => strained.tr_mul(&stiffness_product(own, strained)),
    };
    let mut place = vec![usize::MAX; strained.nrows() / space];
    interior.iter().enumerate().for_each(|(i, &point)| place[point] = i);
    let count = interior.len();
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
        let stretch = DVector::from_fn(cases, |case, _| along(case));
        affine.ger(share * slope, &stretch, &stretch, 1.0);
        for (&row, g) in dofs.iter().zip(gradient) {
            (0..cases).for_each(|case| forces[(row, case)] += slope * g * stretch[case]);
        }
        let own = dofs.iter().zip(gradient).filter(|(dof, _)| place[**dof / space] != usize::MAX);
        let own: Vec<(usize, f64)> = own.map(|(dof, g)| (place[dof / space] * space + dof % space, *g)).collect();
        for &(i, gi) in &own {
            own.iter().for_each(|&(j, gj)| inner[(i, j)] += slope * gi * gj);
        }
    }
    let force =
        DMatrix::from_fn(count * space, cases, |row, case| forces[(interior[row / space] * space + row % space, case)]);
    let (inner, force) = in_frame(inner, force, frame);
    affine - force.tr_mul(&solve(inner, &force))
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

/// Pivots below this share of the largest entry are rounding errors: those of matrices of a few hundred rows are 1e-14 to 1e-13.
const ROUNDING: f64 = 1e-12;

/// `K⁻¹ F`; zero for motions without stiffness.
fn solve(inner: DMatrix<f64>, force: &DMatrix<f64>) -> DMatrix<f64> {
    let largest = inner.diagonal().amax();
    if let Some(factor) = inner.clone().cholesky() {
        // A motion without stiffness has a pivot that is a rounding error, of either sign.
        if factor.l_dirty().diagonal().iter().all(|l| l * l > ROUNDING * largest) {
            return factor.solve(force);
        }
    }
    if !inner.iter().all(|k| k.is_finite()) {
        // The iterations for eigenvalues need not end with numbers that are none.
        return force * f64::NAN;
    }
    let eigen = springfit_numerics::dense::eigen(inner);
    let floor = 1e-10 * eigen.eigenvalues.amax();
    let inverse = eigen.eigenvalues.map(|e| if e.abs() > floor { 1.0 / e } else { 0.0 });
    &eigen.eigenvectors * DMatrix::from_diagonal(&inverse) * eigen.eigenvectors.tr_mul(force)
}

/// `K U`, where the entries are those of the lower triangle of K, for the columns of U.
pub fn stiffness_product(entries: &Entries, u: &DMatrix<f64>) -> DMatrix<f64> {
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
