//! What a reader must know first of a network, in a few words.

use super::linear_theory::{bending_note, distrust};
use super::materials::{difference, is_material};
use crate::study::{ExactOutcome, FitOutcome, Outcome, TooStiff};

/// A network or the finite elements whose cells lock.
pub(super) const LOCKS: &str = "locks";
/// The finite elements of a body that bends and is one cell across.
pub(super) const TOO_STIFF: &str = "too stiff";

/// The dearest that is true of a network: that no figure is to be trusted, that it does not stand or has no equilibrium, that cells are inverted,
/// that constants are not the optimum, that it locks or is too stiff with the finite elements, that it is not the material; otherwise its status.
pub(super) fn verdict(outcome: &Outcome, fit: &FitOutcome) -> String {
    let status = fit.status();
    if distrust(outcome).is_some() {
        "not trusted".into()
    } else if !["fitted", "stable", "converged"].contains(&status) {
        status.into()
    } else if fit.loads.iter().any(|load| load.followed.is_some_and(|followed| followed.inverted > 0)) {
        "inverted cells".into()
    } else if fit.unreached > 0 {
        "not the optimum".into()
    } else if fit.kind.exact().is_some_and(|exact| exact.locking.is_some()) {
        LOCKS.into()
    } else if fit.kind.exact().is_some_and(ExactOutcome::is_finite_elements) && bending_note(outcome).is_some() {
        TOO_STIFF.into()
    } else if !is_material(outcome, fit) {
        match difference(fit) {
            Some(percent) => format!("not the material, {percent} %"),
            None => "not the material".into(),
        }
    } else {
        status.into()
    }
}

/// What a reader must know first of the finite elements of the mesh; empty if they are right.
pub(super) fn finite_elements_verdict(outcome: &Outcome) -> String {
    if distrust(outcome).is_some() {
        return "not trusted".into();
    }
    match outcome.too_stiff {
        Some(TooStiff::Locks(_)) => LOCKS.into(),
        Some(TooStiff::Bends | TooStiff::Coarse) => TOO_STIFF.into(),
        None => String::new(),
    }
}
