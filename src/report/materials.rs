//! What the networks are as materials, in words.

use crate::study::{FitOutcome, Outcome};

/// The share by which a tensor or Young's modulus may be off before a network is warned of.
const FAR: f64 = 0.1;

/// A warning of a network that is far from the material.
pub(super) fn material_note(outcome: &Outcome, fit: &FitOutcome) -> Option<String> {
    let (name, m) = (&fit.fit.name, &fit.as_material);
    // A guess that the fit was to replace; or constants that are stiffer than the material by what an engine leaves.
    let is_for_engine = fit.engine.is_some();
    if is_for_engine || fit.kind.whole().is_some_and(|whole| whole.is_measured) {
        return None;
    }
    // Of springs that belong to no cell nothing is known where membranes or rods are beside them.
    if outcome.mesh.is_mixed() && !m.distance.is_finite() {
        return None;
    }
    // Near the incompressible the tensor is nearly that of changes of volume: E says what it does not.
    let is_near = |(young, asked): (f64, f64)| (young / asked - 1.0).abs() <= FAR;
    let is_modulus = m.young.zip(m.asked_young).is_some_and(is_near);
    if m.distance <= FAR && is_modulus {
        return None;
    }
    let off = match percent(m.distance) {
        Some(percent) => format!("its elasticity tensor C differs by {percent} %"),
        None => "its elasticity tensor C is not finite".into(),
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
    let remedy = if has_remedy { ". The objective \"exact\" has no such error" } else { "" };
    Some(format!("{name}: the network is not the material: {off} ({of}; {asked}){remedy}"))
}

/// In percent with a digit behind the point; rounding is zero.
fn percent(share: f64) -> Option<String> {
    share.is_finite().then(|| format!("{:.1}", 100.0 * share))
}
