//! The moduli that a whole-object fit has found, with their intervals.

use super::evidence::Evidence;
use super::moduli::{FoundModuli, FoundModulus, ModuliSearch, excess};
use super::recipe::WholeRecipe;
use crate::whole::{Object, WEAK, WholeFit, ninety_five};

/// The moduli of the body or its regions with their intervals, where these are the unknowns. `mesh` has the deviations of their logarithms
/// that the meshes cause, if they are known.
pub(super) fn found_moduli(
    recipe: &WholeRecipe,
    object: &Object,
    found: &WholeFit,
    evidence: Evidence,
    mesh: &[f64],
) -> FoundModuli {
    let Some(sharing) = recipe.unknowns.moduli() else { return FoundModuli::default() };
    let names = object.modulus_names(sharing);
    let factors = object.modulus_factors(&found.theta).unwrap_or_default();
    let Evidence { known, shifts, misfit, searched } = evidence;
    let chosen = found.curve.iter().find(|stage| Some(stage.regularization) == found.regularization);
    let search = match (searched, chosen.is_none_or(|stage| stage.is_finished)) {
        (Some(false), _) => ModuliSearch::Lost,
        (Some(true), false) => ModuliSearch::Ended,
        (Some(true), true) | (None, _) => ModuliSearch::Finished,
    };
    let reach = |p: usize| {
        let known = known.as_ref()?;
        let of_mesh = ninety_five(None) * mesh.get(p).copied().unwrap_or(0.0);
        Some((excess(misfit) * known.reach * known.deviations[p]?).hypot(of_mesh))
    };
    let modulus = |(p, (name, factor)): (usize, (&String, f64))| {
        // From the value that was found to the one without ρ, and the deviations beyond either end.
        let ends =
            |reach: f64| [factor * (shifts[p].min(0.0) - reach).exp(), factor * (shifts[p].max(0.0) + reach).exp()];
        // An interval with an end that is zero or infinite is left out.
        let interval = reach(p).map(ends).filter(|[low, high]| *low > 0.0 && high.is_finite());
        FoundModulus { name: name.clone(), factor, interval, mesh: mesh.get(p).copied() }
    };
    let all: Vec<FoundModulus> = names.iter().zip(factors).enumerate().map(modulus).collect();
    let together = |unknowns: &Vec<usize>| unknowns.iter().map(|p| names[*p].clone()).collect::<Vec<_>>().join(", ");
    let mut weak: Vec<String> = known.iter().flat_map(|known| known.weak.iter().map(together)).collect();
    let mut seen = std::collections::HashSet::new();
    weak.retain(|words| seen.insert(words.clone()));
    for (p, modulus) in all.iter().enumerate() {
        let is_listed = known.iter().any(|known| known.weak.iter().any(|together| together.contains(&p)));
        if !is_listed && reach(p).is_some_and(|reach| reach > WEAK.ln()) {
            weak.push(modulus.name.clone());
        }
    }
    FoundModuli { all, weak, misfit, search }
}
