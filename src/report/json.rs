//! `report.json`: stable keys, numbers in SI units, errors of displacements in percent.

use super::agreement::{Agreement, SAME, agreements};
use super::frequencies::frequency_json;
use super::motion::{motion_json, motion_options};
use crate::fit::{Family, Fit, Norm, Objective, Solver, Source, Spread, Weights};
use crate::mesh::Mesh;
use crate::solve::{Ending, Standing};
use crate::study::{
    FitOutcome, FittedLoad, Followed, ForceRecipe, LoadOutcome, MeasuredLoad, Outcome, Reading, Recipe, SampledRecipe,
    Start, WholeRecipe,
};
use crate::whole::{Method, Residual};
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
        "quality": quality(&outcome.mesh),
        "springs": outcome.fits.iter().map(|f| f.network.len()).max(),
        "young": outcome.material.young(),
        "poisson": outcome.material.poisson(),
        "law": outcome.law,
        "loads_followed": outcome.followed.iter().map(followed).collect::<Vec<_>>(),
        "left_out": outcome.left_out,
        "measured": outcome.measured.iter().map(measured).collect::<Vec<_>>(),
        "gauge": outcome.gauged.iter().map(|r| r.map(reading)).collect::<Vec<_>>(),
        "starts": agreements(outcome).iter().map(agreement).collect::<Vec<_>>(),
        "frequencies": outcome.frequencies.iter().map(frequency_json).collect::<Vec<_>>(),
        "motion_options": outcome.motion.as_ref().map(motion_options),
        "motion": outcome.motion.iter().flat_map(|motion| &motion.models).map(motion_json).collect::<Vec<_>>(),
        "fits": outcome.fits.iter().map(|f| fit(f, outcome.mesh.cell_count(), outcome.material.thickness())).collect::<Vec<_>>(),
    });
    serde_json::to_string_pretty(&value).expect("a value of finite numbers and text is JSON") + "\n"
}

fn quality(mesh: &Mesh) -> Value {
    let quality = &mesh.quality;
    json!({
        "worst": quality.worst.as_ref().map(|worst| worst.quality),
        "worst_cell": quality.worst.as_ref().map(|worst| worst.cell.as_str()),
        "poor_elements": quality.poor,
        "skipped_elements": quality.skipped,
        "coincident_nodes": quality.coincident,
        "hanging_nodes": quality.hanging,
    })
}

fn reading(reading: Reading) -> Value {
    json!({ "young": reading.young, "poisson": reading.poisson })
}

fn measured(load: &MeasuredLoad) -> Value {
    json!({
        "load": load.name,
        "points": load.points,
        "fem_e_rms": load.error.map(|e| e.rms),
        "fem_e_max": load.error.map(|e| e.max),
    })
}

fn agreement(agreement: &Agreement) -> Value {
    json!({
        "fits": agreement.fits,
        "load": agreement.load,
        "difference": agreement.difference,
        "agree": agreement.difference <= SAME,
    })
}

fn fit(outcome: &FitOutcome, elements: usize, thickness: f64) -> Value {
    let mut value = match &outcome.fit.recipe {
        Recipe::Stiffness(fit) => of_stiffness(fit),
        Recipe::Forces(recipe) => of_forces(recipe),
        Recipe::Whole(recipe) => of_whole(recipe),
        Recipe::Published(method) => json!({ "objective": method.name(), "source": method.reference() }),
    };
    let rest = json!({
        "name": outcome.fit.name,
        "groups": outcome.fit.springs,
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
        "unmet": outcome.unmet.map(|unmet| json!({
            "poisson_assumed": unmet.poisson,
            "elements_of_other_shape": unmet.cells,
            "largest_deviation": unmet.deviation,
        })),
        "whole": outcome.whole.as_ref().map(|w| json!({
            "loads": w.loads,
            "validated": w.validated,
            "regularization": w.regularization,
            "largest_change": w.change,
            "range": w.range,
            "limited_by_range": w.limited,
            "steps": w.steps,
            "cancelled": w.cancelled,
            "stands": w.stands,
            "relative_errors_fitted": w.fitted.iter().map(fitted).collect::<Vec<_>>(),
            "relative_errors_validated": w.judged.iter().map(fitted).collect::<Vec<_>>(),
            "relative_errors_of_frequencies": { "before": w.frequencies[0], "after": w.frequencies[1] },
        })),
        "sampled": outcome.sampled.as_ref().map(|s| json!({
            "shapes": s.shapes,
            "trained": spread(Some(s.trained)),
            "held_out": s.held_out.map(|held_out| spread(Some(held_out))),
            "agreeing_starts": s.agreeing,
            "loads": s.loads,
        })),
    });
    if let (Value::Object(value), Value::Object(rest)) = (&mut value, rest) {
        value.extend(rest);
    }
    value
}

fn of_stiffness(fit: &Fit) -> Value {
    json!({
        "objective": fit.objective.name(),
        "weight": fit.objective.weight().map(|w| w.name()),
        "higher": fit.objective.higher(),
        "balance": if let Objective::Divergence { balance } = fit.objective { Some(balance) } else { None },
        "tied": fit.tied,
        "nonnegative": fit.nonnegative,
        "solver": match (fit.objective, fit.nonnegative) {
            _ if fit.solver != Solver::Native => fit.solver.name(),
            (Objective::Frobenius(_), false) => "normal equations",
            (Objective::Frobenius(_), true) => "block principal pivoting",
            (Objective::Spectral(_), _) => "barrier",
            (Objective::Divergence { .. }, _) => "newton",
        },
        "sparsity": fit.solver.topology().map(|topology| topology.sparsity),
    })
}

fn of_forces(recipe: &SampledRecipe) -> Value {
    let fit = &recipe.fit;
    json!({
        "objective": "sampled",
        "weight": if fit.weights == Weights::Relative { "relative" } else { "none" },
        "higher": fit.higher,
        "tied": fit.tied,
        "nonnegative": fit.nonnegative,
        "force": match &recipe.force {
            ForceRecipe::Linear => json!("linear"),
            ForceRecipe::FreeRest => json!("free-rest"),
            ForceRecipe::Law(law) => json!(law.text),
            ForceRecipe::Groups(laws) => laws.iter().map(|(group, law)| (group.clone(), json!(law.text))).collect(),
        },
        "norm": match fit.norm {
            Norm::Two => "2",
            Norm::One => "1",
            Norm::Max => "max",
            Norm::Huber { .. } => "huber",
        },
        "huber": if let Norm::Huber { share } = fit.norm { Some(share) } else { None },
        "bounds": fit.bounds.iter().map(|(name, range)| (name.clone(), json!(range))).collect::<Value>(),
        "starts": fit.starts,
        "families": match &fit.sampling.source {
            Source::Families(families) if recipe.loads.is_empty() => json!(families.iter().map(Family::name).collect::<Vec<_>>()),
            _ => Value::Null,
        },
        "stretch": fit.sampling.stretch,
        "perturbation": fit.sampling.perturbation,
        "seed": fit.sampling.seed,
        "law": recipe.law,
    })
}

fn of_whole(recipe: &WholeRecipe) -> Value {
    let objective = match &recipe.start {
        Start::Fit(fit) => Some(fit.objective),
        Start::Sampled(_) | Start::Equal => None,
    };
    json!({
        "objective": "whole",
        "start": match &recipe.start {
            Start::Fit(fit) => json!(fit.objective.name()),
            Start::Sampled(recipe) => of_forces(recipe),
            Start::Equal => json!("equal"),
        },
        "weight": objective.and_then(|objective| objective.weight()).map(|w| w.name()),
        "higher": objective.and_then(|objective| objective.higher()),
        "unknowns": recipe.unknowns.name(),
        "residual": match recipe.settings.residual {
            Residual::Displacements => "displacements",
            Residual::Forces => "forces",
            Residual::ForcesFirst => "forces-first",
        },
        "solver": match recipe.settings.method {
            Method::GaussNewton(_) => "gauss-newton",
            Method::Lbfgs { .. } => "l-bfgs",
        },
        "frequencies": recipe.frequencies,
        "seed": recipe.seed,
    })
}

fn fitted(load: &FittedLoad) -> Value {
    json!({ "load": load.name, "before": load.before, "after": load.after })
}

fn spread(spread: Option<Spread>) -> Value {
    json!({ "mean": spread.map(|s| s.mean), "max": spread.map(|s| s.max) })
}

fn load(outcome: &LoadOutcome) -> Value {
    json!({
        "name": outcome.name,
        "e_rms": outcome.error.map(|e| e.rms),
        "e_max": outcome.error.map(|e| e.max),
        "seconds_fem": outcome.seconds_fem,
        "seconds_lem": outcome.seconds_lem,
        "followed": outcome.followed.as_ref().map(followed),
        "gauge": outcome.gauged.map(reading),
    })
}

fn followed(followed: &Followed) -> Value {
    json!({
        "converged": followed.ending == Ending::Converged,
        "load": followed.load,
        "residual": followed.residual,
        "iterations": followed.iterations,
        "shifted": followed.shifted,
        "inverted_elements": followed.inverted,
    })
}

/// One word for how the network stands.
pub fn status(outcome: &FitOutcome) -> &'static str {
    let mut followed = outcome.loads.iter().filter_map(|load| load.followed).peekable();
    if followed.peek().is_some() {
        return if followed.all(|f| f.ending == Ending::Converged) { "converged" } else { "stalled" };
    }
    match outcome.stability.as_ref().map(|s| s.standing) {
        None => "fitted",
        Some(Standing::Sound) => "sound",
        Some(Standing::Soft) => "near-mechanism",
        Some(Standing::Indefinite) => "indefinite",
        Some(Standing::Singular) => "mechanism",
    }
}
