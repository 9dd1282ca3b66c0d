//! What the networks are as materials, in words.

use super::note::{Note, Weight};
use crate::study::{FitOutcome, Outcome};

/// The share by which a tensor or Young's modulus may be off before a network is warned of.
// Displacements are off by about as much. It was chosen: the moduli of most bodies are known no better.
const FAR: f64 = 0.1;

/// Whether the network is the material that was asked for, as far as a fit is to be it.
pub(super) fn is_material(outcome: &Outcome, fit: &FitOutcome) -> bool {
    let m = &fit.as_material;
    // Constants of the whole object answer as the body, with others than the material has; those for an engine are stiffer by what it leaves.
    if fit.engine.is_some() || fit.kind.whole().is_some() {
        return true;
    }
    // Of springs that belong to no cell nothing is known where membranes or rods are beside them.
    if outcome.mesh.is_mixed() && !m.distance.is_finite() {
        return true;
    }
    // The tensor of several materials is compared with that of finite elements. Where these lock, networks that do not are rightly another.
    let is_unlocked = fit.kind.exact().is_some_and(|exact| !exact.is_finite_elements());
    if is_unlocked && outcome.locks_at().is_some() && outcome.material.uniform().is_none() {
        return true;
    }
    // Near the incompressible the tensor is nearly that of changes of volume: E says what it does not.
    let is_near = |(young, asked): (f64, f64)| (young / asked - 1.0).abs() <= FAR;
    m.distance <= FAR && m.young.zip(m.asked_young).is_some_and(is_near)
}

/// How far the network is from the material in percent, without digits behind the point: that of the tensor, or of E where the tensor is near.
/// It is none if it is not finite.
pub(super) fn difference(fit: &FitOutcome) -> Option<String> {
    let m = &fit.as_material;
    let of_young = m.young.zip(m.asked_young).map_or(0.0, |(young, asked)| (young / asked - 1.0).abs());
    let share = if m.distance <= FAR { of_young } else { m.distance };
    share.is_finite().then(|| format!("{:.0}", 100.0 * share))
}

/// A warning of a network that is far from the material.
pub(super) fn material_note(outcome: &Outcome, fit: &FitOutcome) -> Option<Note> {
    if is_material(outcome, fit) {
        return None;
    }
    let (name, m) = (&fit.fit.name, &fit.as_material);
    let off = match m.distance.is_finite() {
        true => format!("its elasticity tensor C differs by {:.1} %", 100.0 * m.distance),
        false => "its elasticity tensor C is not finite".into(),
    };
    let of = match (m.young, m.poisson) {
        (Some(young), Some(poisson)) => format!("E = {young:.4e} Pa, nu = {poisson:.3}"),
        (Some(young), None) => format!("E = {young:.4e} Pa"),
        (None, _) => "a strain has no stiffness".into(),
    };
    let asked = match (outcome.material.uniform(), m.asked_young, m.asked_poisson) {
        (Some(asked), ..) => format!("the material has {:e} Pa, {}", asked.young(), asked.poisson()),
        (None, Some(young), Some(poisson)) => format!("the materials there have {young:.4e} Pa, {poisson:.3}"),
        (None, Some(young), None) => format!("the materials there have {young:.4e} Pa"),
        (None, None, _) => "the materials differ from cell to cell".into(),
    };
    // Exact networks are those of isotropic materials, and are not recommended in place of themselves.
    let has_remedy = outcome.material.materials().is_ok() && fit.kind.exact().is_none();
    let remedy = match (has_remedy, outcome.locks_at()) {
        (false, _) => "",
        (true, None) => ". The objective \"exact\" has no such error",
        (true, Some(_)) => {
            ". The objective \"exact\" has no such error, and with volume = \"cells\" or \"patches\" it does not lock"
        }
    };
    let note = Note::of_model(Weight::Model, name, "the network is not the material");
    Some(note.figures(format!(": {off} ({of}; {asked})")).advice(remedy))
}
