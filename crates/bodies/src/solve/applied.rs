//! The forces that act on a body, some of which follow it.

use super::linear::{Factor, System};
use crate::model::{Entries, PressedFaces, displaced};
use crate::springs::dot;
use faer::sparse::Triplet;
use std::borrow::Cow;

/// The largest number of corrections of a step for the part of a tangent that is not symmetric. Where they do not end,
/// the step is one of many that Newton's method corrects.
const CORRECTIONS: usize = 60;
/// Corrections end when one is below this share of the first: a relative error of the step that Newton's method does not notice.
const CORRECTED: f64 = 1e-8;

/// Nodal forces, and the faces on which some of them are pressures that follow the body.
#[derive(Debug, Clone, Copy)]
pub struct Applied<'a> {
    /// With the points at rest, `[points · dimension]`, N.
    pub forces: &'a [f64],
    /// The faces of the pressures among them.
    pub pressed: Option<&'a PressedFaces>,
}

/// Forces that keep their directions.
impl<'a, F: AsRef<[f64]> + ?Sized> From<&'a F> for Applied<'a> {
    fn from(forces: &'a F) -> Applied<'a> {
        Applied { forces: forces.as_ref(), pressed: None }
    }
}

impl<'a> Applied<'a> {
    /// The forces at the displacements u from the positions at rest, `[points · dimension]`, N.
    pub fn at(&self, rest: &[f64], u: &[f64]) -> Cow<'a, [f64]> {
        let Some(pressed) = self.pressed else { return Cow::Borrowed(self.forces) };
        let (at_rest, now) = (pressed.forces(rest), pressed.forces(&displaced(rest, u)));
        // `forces` holds the pressures on the faces as they are at rest; they give way to those on the faces where
        // these are now.
        Cow::Owned(self.forces.iter().zip(at_rest.iter().zip(now)).map(|(f, (rest, now))| f - rest + now).collect())
    }

    /// The work of the forces that do not follow from rest to the displacements `to`, and of those that follow on the straight way from the displacements
    /// `from`, J.
    pub(super) fn work(&self, rest: &[f64], from: &[f64], to: &[f64]) -> f64 {
        let own = dot(self.forces, to);
        let Some(pressed) = self.pressed else { return own };
        let way: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
        // The work of `forces` has that of the pressures at rest, which is taken off again. Pressures on free edges
        // have no potential, so that the work depends on the way; a line search asks for the straight one alone.
        own - dot(&pressed.forces(rest), to) + pressed.work(&displaced(rest, from), &way)
    }

    /// What forces that follow add to the tangent of the model under the share `load` of them.
    pub(super) fn stiffness(&self, rest: &[f64], u: &[f64], load: f64) -> Following {
        let Some(pressed) = self.pressed else { return Following::default() };
        let mut entries = pressed.tangent(&displaced(rest, u));
        // The tangent of a model is that of forces which resist, and these forces act: hence the sign.
        entries.iter_mut().for_each(|entry| entry.val *= -load);
        Following { entries }
    }
}

/// The stiffness of forces that follow a body: minus the derivatives of the forces in the positions, N/m.
#[derive(Debug, Default)]
pub(super) struct Following {
    entries: Vec<Triplet<usize, usize, f64>>,
}

impl Following {
    /// Whether nothing follows.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The entries of the symmetric part, `(T + Tᵀ)/2`, in the lower triangle.
    pub fn symmetric(&self) -> Entries {
        let half = |entry: &Triplet<usize, usize, f64>| {
            let (row, column) = (entry.row.max(entry.col), entry.row.min(entry.col));
            // T has the entries above and below its diagonal. Both come to the same place, each with its half.
            Triplet::new(row, column, if row == column { entry.val } else { entry.val / 2.0 })
        };
        self.entries.iter().map(half).collect()
    }

    /// The product of the other part, `A = (T − Tᵀ)/2`, with v.
    fn skew_product(&self, v: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; v.len()];
        for entry in &self.entries {
            product[entry.row] += entry.val * v[entry.col] / 2.0;
            product[entry.col] -= entry.val * v[entry.row] / 2.0;
        }
        product
    }

    /// The solution of `(S + A) d = r` from that of `S d = r`, with the factor of S, which is positive definite: by the method of Concus and Golub
    /// (1976) and Widlund (SIAM J. Numer. Anal. 15, 1978) for a skew part A, whose steps need no more than the last two.
    pub fn corrected(&self, system: &System, factor: &Factor, solution: Vec<f64>) -> Vec<f64> {
        let free = |v: &[f64]| -> Vec<f64> { system.free().iter().map(|&dof| v[dof]).collect() };
        // What S d lacks of the forces: S d = r at the start.
        let mut lack = vec![0.0; solution.len()];
        let (mut last, mut now) = (solution.clone(), solution);
        let mut last_lack = lack.clone();
        // The infinite square marks the first step, which has no step before it to be weighed against.
        let (mut weight, mut square, mut first) = (1.0, f64::INFINITY, None);
        for _ in 0..CORRECTIONS {
            let rest: Vec<f64> = lack.iter().zip(self.skew_product(&now)).map(|(lack, skew)| lack - skew).collect();
            let correction = system.respond_all(factor, std::slice::from_ref(&rest)).remove(0);
            // The square of the correction in the norm of S, which falls from step to step but for rounding.
            let own = dot(&free(&correction), &free(&rest));
            // In this form a square that is NaN ends the corrections as well.
            if !(own > CORRECTED * CORRECTED * *first.get_or_insert(own)) {
                break;
            }
            weight = if square.is_finite() { 1.0 / (1.0 + own / (square * weight)) } else { 1.0 };
            square = own;
            let next = |last: &[f64], now: &[f64], step: &[f64]| -> Vec<f64> {
                let pairs = last.iter().zip(now).zip(step);
                pairs.map(|((last, now), step)| last + weight * (step + now - last)).collect()
            };
            let ahead = next(&last, &now, &correction);
            (last, now) = (now, ahead);
            // S of the correction is what was left.
            let taken: Vec<f64> = rest.iter().map(|rest| -rest).collect();
            let ahead = next(&last_lack, &lack, &taken);
            (last_lack, lack) = (lack, ahead);
        }
        now
    }
}
