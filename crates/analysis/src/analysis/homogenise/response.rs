//! How free points give way, also where some motions meet no resistance.

use crate::error::{Error, ErrorKind, Result};
use crate::model::{Entries, Support};
use crate::solve::System;
use faer::sparse::Triplet;
use nalgebra::DMatrix;

/// The share of the largest diagonal entry that is added to the diagonal, so that motions without resistance have a factor.
const SHIFT: f64 = 1e-9;
/// The residual at which the corrections end, relative to the forces: some roundings.
const ENOUGH: f64 = 1e-14;
/// The residual beyond which the displacements are no solution.
// The residual of a motion with 0.31 of the shift is divided by 1.31 in each of the 60 corrections below, and is this share
// of the forces after them.
const SOLVED: f64 = 1e-7;
/// Forces below this share of those of all points, before images are added, are what rounding leaves of none.
const NONE: f64 = 1e-12;
/// Corrections at most: a motion as soft as the shift loses half of its error in each.
const CORRECTIONS: usize = 60;

/// The displacements under forces.
pub struct Response {
    /// `[degrees of freedom × cases]`, m; zero where points are held.
    pub displacements: DMatrix<f64>,
    /// Whether no motion of the free points releases energy.
    pub is_stable: bool,
}

/// `K W = F` on the free degrees of freedom: the displacements of least energy. F does no work on motions without resistance, as forces of a
/// strain do none; of these motions W has nothing.
///
/// With a little added to its diagonal, `K + δ I`, the matrix has a Cholesky factor unless some motion releases energy, and the
/// corrections `W ← W + (K + δ I)⁻¹ (F − K W)` remove what was added (the proximal point method). `scale` is the size of the forces of which F
/// is the sum, N.
///
/// # Errors
/// The matrix does not fit into memory, or no displacements balance the forces: kind `Infeasible`.
pub fn respond(
    entries: &Entries,
    support: &Support,
    (points, d): (&[f64], usize),
    forces: &DMatrix<f64>,
    scale: f64,
) -> Result<Response> {
    let largest = entries.iter().filter(|e| e.row == e.col).map(|e| e.val.abs()).fold(0.0, f64::max);
    let system = System::new(entries, support)?;
    let mut raised = entries.clone();
    raised.extend((0..support.prescribed.len()).map(|dof| Triplet::new(dof, dof, SHIFT * largest)));
    let raised = System::new(&raised, support)?.placed(points, d);
    let (factor, is_stable) = match raised.cholesky()? {
        Some(factor) => (factor, true),
        // A motion that releases energy has no Cholesky factor; the equilibrium is found all the same, and told as unstable.
        None => (raised.general()?.ok_or_else(unbalanced)?, false),
    };
    let free = system.free();
    let mut displacements = DMatrix::zeros(support.prescribed.len(), forces.ncols());
    for case in 0..forces.ncols() {
        let force: Vec<f64> = free.iter().map(|&dof| forces[(dof, case)]).collect();
        let size = norm(&force);
        let (mut w, mut left) = (vec![0.0; free.len()], force.clone());
        let mut best = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            let residual = norm(&left);
            // Rounding ends the corrections: a residual that does not fall any more is what is left of the digits.
            if residual <= (ENOUGH * size).max(NONE * NONE * scale) || size <= NONE * scale || !(residual < best) {
                break;
            }
            best = residual;
            let mut correction = left;
            factor.solve(&mut correction);
            w.iter_mut().zip(&correction).for_each(|(w, c)| *w += c);
            let image = system.apply(&w);
            left = force.iter().zip(image).map(|(f, k)| f - k).collect();
        }
        if !(norm(&left) <= (SOLVED * size).max(NONE * scale)) {
            return Err(unbalanced());
        }
        free.iter().zip(&w).for_each(|(&dof, w)| displacements[(dof, case)] = *w);
    }
    Ok(Response { displacements, is_stable })
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn unbalanced() -> Error {
    let expected = "points that find an equilibrium under a strain";
    Error::expected("springs", expected, "a motion without resistance that the strain drives")
        .of_kind(ErrorKind::Infeasible)
}
