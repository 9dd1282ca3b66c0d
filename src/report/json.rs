//! `report.json`: stable keys, numbers in SI units, errors of displacements in percent.

use crate::fit::{Objective, Solver, Spread};
use crate::solve::Standing;
use crate::study::{FitOutcome, LoadOutcome, Outcome};
use serde_json::{Value, json};

/// The report as text.
pub fn report(outcome: &Outcome) -> String {
    let value = json!({
        "scene": outcome.scene,
        "nodes": outcome.mesh.point_count(),
        "elements": outcome.mesh.cell_count(),
        "element_types": outcome.mesh.blocks.iter().map(|b| b.element.name.as_str()).collect::<Vec<_>>(),
        "turned_elements": outcome.mesh.reversed,
        "unused_nodes": outcome.mesh.unused_points,
        "springs": outcome.fits.iter().map(|f| f.network.len()).max(),
        "young": outcome.material.young(),
        "poisson": outcome.material.poisson(),
        "left_out": outcome.left_out,
        "fits": outcome.fits.iter().map(|f| fit(f, outcome.mesh.cell_count(), outcome.material.thickness())).collect::<Vec<_>>(),
    });
    serde_json::to_string_pretty(&value).expect("a value of finite numbers and text is JSON") + "\n"
}

fn fit(outcome: &FitOutcome, elements: usize, thickness: f64) -> Value {
    let fit = &outcome.fit.fit;
    json!({
        "name": outcome.fit.name,
        "objective": fit.objective.name(),
        "weight": fit.objective.weight().map(|w| w.name()),
        "higher": fit.objective.higher(),
        "balance": if let Objective::Divergence { balance } = fit.objective { Some(balance) } else { None },
        "groups": outcome.fit.springs,
        "tied": fit.tied,
        "nonnegative": fit.nonnegative,
        "solver": match (fit.objective, fit.nonnegative) {
            _ if fit.solver != Solver::Native => fit.solver.name(),
            (Objective::Frobenius(_), false) => "normal equations",
            (Objective::Frobenius(_), true) => "block principal pivoting",
            (Objective::Spectral(_), _) => "barrier",
            (Objective::Divergence { .. }, _) => "newton",
        },
        "status": status(outcome),
        "springs": outcome.network.len(),
        "seconds": outcome.seconds,
        "seconds_per_element": outcome.seconds / elements.max(1) as f64,
        "seconds_assembly": outcome.seconds_assembly,
        "relative_frobenius": spread(outcome.frobenius),
        "relative_spectral": spread(outcome.spectral),
        "negative_springs": outcome.network.negative(),
        "undetermined_elements": outcome.deficient,
        "energy_ratio": outcome.stability.as_ref().map(|s| s.energy_ratio),
        "loose_nodes": outcome.loose_points,
        "certificate_gap": outcome.gap,
        "reused_elements": outcome.reused,
        "ambiguous_elements": outcome.ambiguous,
        "unreached_elements": outcome.unreached,
        "energy_error_bound": outcome.energy_error,
        "effective_young": outcome.moduli.as_ref().map(|m| m.young / thickness),
        "effective_poisson": outcome.moduli.as_ref().map(|m| m.poisson),
        "zener": outcome.moduli.as_ref().map(|m| m.zener),
        "loads": outcome.loads.iter().map(load).collect::<Vec<_>>(),
    })
}

fn spread(spread: Spread) -> Value {
    json!({ "mean": spread.mean, "max": spread.max })
}

fn load(outcome: &LoadOutcome) -> Value {
    json!({
        "name": outcome.name,
        "e_rms": outcome.error.map(|e| e.rms),
        "e_max": outcome.error.map(|e| e.max),
        "seconds_fem": outcome.seconds_fem,
        "seconds_lem": outcome.seconds_lem,
    })
}

/// One word for how the network stands.
pub fn status(outcome: &FitOutcome) -> &'static str {
    match outcome.stability.as_ref().map(|s| s.standing) {
        None => "fitted",
        Some(Standing::Sound) => "sound",
        Some(Standing::Soft) => "near-mechanism",
        Some(Standing::Indefinite) => "indefinite",
        Some(Standing::Singular) => "mechanism",
    }
}
