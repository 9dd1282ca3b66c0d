//! The settings and errors of a whole-object fit in a report.

use super::moduli::FoundModulus;
use super::outcome::{
    FittedLoad, FittedMasses, HeldOut, ModelError, ModelFrequencies, SupportFrequencies, WholeOutcome, WorseLoad,
};
use super::recipe::{Start, WholeRecipe};
use crate::study::fits::sampled::SampledRecord;
use crate::whole::{MassStage, Stage};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings, with defaults filled in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WholeRecord {
    /// The objective, `whole`.
    pub objective: String,
    /// The constants from which the fit starts.
    pub start: StartRecord,
    /// The weight of the objective of the start.
    pub weight: Option<String>,
    /// The scale of the motions beyond constant strain in that weight.
    pub higher: Option<f64>,
    /// Which springs share an unknown factor: `spring`, `group`, `region` or `element`.
    pub unknowns: String,
    /// The residuals: `displacements`, `forces` or `forces-first`.
    pub residual: String,
    /// The solver.
    pub solver: String,
    /// The number of natural frequencies that are fitted.
    pub frequencies: usize,
    /// The number of natural frequencies to which the masses are fitted after the springs.
    pub masses: usize,
    /// The seed of the random loads.
    pub seed: u64,
    /// The groups that are held, for each support under which made loads are fitted; empty for that of the scene.
    pub supports: Vec<Vec<String>>,
    /// The same for the loads that choose the regularization; empty for those of the fit.
    pub validate_supports: Vec<Vec<String>>,
    /// The same for loads that are neither fitted nor choose it, whose errors are reported.
    #[serde(default)]
    pub other_supports: Vec<Vec<String>>,
}

/// The start: an objective or "equal", or the settings of a sampled fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum StartRecord {
    Name(String),
    Sampled(Box<SampledRecord>),
}

/// The loads of the fit, and its result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WholeOutcomeRecord {
    /// The names of the loads that were fitted.
    pub loads: Vec<String>,
    /// The names of the loads that chose the regularization.
    pub validated: Vec<String>,
    /// The regularization that was chosen; null if the start was best.
    pub regularization: Option<f64>,
    /// The largest factor by which a constant changed.
    pub largest_change: Option<f64>,
    /// The ratio of the largest to the least constant of the length springs.
    pub range: Option<f64>,
    /// Whether a better regularization was rejected because of this ratio.
    pub limited_by_range: bool,
    /// The stages of the path: the curve of errors against ρ.
    pub curve: Vec<StageRecord>,
    /// The number of steps.
    pub steps: usize,
    /// Whether the fit was cancelled.
    pub cancelled: bool,
    /// Whether the network is stable under every load at the start.
    pub stands: bool,
    /// The relative errors on the loads of the fit.
    pub relative_errors_fitted: Vec<FittedLoadRecord>,
    /// The relative errors on the loads that chose the regularization.
    pub relative_errors_validated: Vec<FittedLoadRecord>,
    /// The factors on the moduli of the body or of its regions, if these are the unknowns.
    pub moduli: Vec<FoundModulusRecord>,
    /// The moduli that the displacements hardly see, or not at all: one alone, or several whose combination they do not see.
    pub hardly_seen: Vec<String>,
    /// How many times as large as the stated noise the residuals are; null where it is not stated.
    pub misfit: Option<f64>,
    /// The relative errors under loads that were neither fitted nor chose the regularization.
    pub held_out: Vec<HeldOutRecord>,
    /// The relative errors of the frequencies.
    pub relative_errors_of_frequencies: FrequencyErrorsRecord,
    /// The masses, if they were fitted.
    pub masses: Option<FittedMassesRecord>,
}

/// Masses that were fitted to frequencies. The masses themselves are in the file of the network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FittedMassesRecord {
    /// The number of frequencies that were fitted under each support.
    pub frequencies: usize,
    /// The regularization that was chosen.
    pub regularization: f64,
    /// The largest error of the second moments on the diagonal, relative to those of the body.
    pub second_moment_error: f64,
    /// The largest factor by which a mass changed.
    pub largest_change: f64,
    /// Their sum, kg.
    pub total: f64,
    /// The share of lumped masses in the mass matrix; the rest is the consistent one.
    #[serde(default)]
    pub lumped_share: f64,
    /// ρ, and the root mean square errors of the frequencies that were fitted and that chose ρ.
    pub curve: Vec<MassStageRecord>,
    /// The errors of frequencies under each support.
    pub supports: Vec<SupportFrequenciesRecord>,
}

/// A point of the curve of errors of frequencies against ρ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MassStageRecord {
    pub regularization: f64,
    pub trained: f64,
    /// Null where no frequencies choose.
    pub validated: Option<f64>,
}

/// The errors of frequencies under a support.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SupportFrequenciesRecord {
    /// The groups that are held.
    pub support: String,
    /// Whether the first frequencies were fitted.
    pub trained: bool,
    /// Whether they chose the regularization without being fitted.
    #[serde(default)]
    pub chooses: bool,
    /// The finite elements of the mesh and the network with lumped masses, and the network with fitted ones and with the mass matrix.
    pub models: Vec<ModelFrequenciesRecord>,
}

/// The root mean squares of the relative errors `ω_i/ω̄_i − 1` of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelFrequenciesRecord {
    pub model: String,
    /// Of the first frequencies.
    pub first: f64,
    /// Of as many after these, which no fit has seen.
    pub next: f64,
}

impl FittedMassesRecord {
    fn of(found: &FittedMasses) -> FittedMassesRecord {
        let model =
            |m: &ModelFrequencies| ModelFrequenciesRecord { model: m.model.into(), first: m.first, next: m.next };
        let support = |of: &SupportFrequencies| SupportFrequenciesRecord {
            support: of.support.clone(),
            trained: of.part.is_fitted(),
            chooses: of.part.is_consulted(),
            models: of.models.iter().map(model).collect(),
        };
        let stage = |stage: &MassStage| MassStageRecord {
            regularization: stage.regularization,
            trained: stage.trained,
            validated: stage.validated,
        };
        FittedMassesRecord {
            frequencies: found.count,
            regularization: found.regularization,
            second_moment_error: found.second_error,
            largest_change: found.change,
            total: found.total,
            lumped_share: found.share,
            curve: found.curve.iter().map(stage).collect(),
            supports: found.supports.iter().map(support).collect(),
        }
    }
}

/// The factor on a modulus.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FoundModulusRecord {
    /// The modulus and the region.
    pub modulus: String,
    /// The factor on that of the material.
    pub factor: f64,
    /// The ends of the 95 % interval; null if the displacements do not determine it.
    pub interval: Option<[f64; 2]>,
    /// The standard deviation of its logarithm that the meshes cause, which is in the interval; null without a finer body.
    pub mesh_deviation: Option<f64>,
}

impl FoundModulusRecord {
    fn of(found: &FoundModulus) -> FoundModulusRecord {
        FoundModulusRecord {
            modulus: found.name.clone(),
            factor: found.factor,
            interval: found.interval,
            mesh_deviation: found.mesh,
        }
    }
}

/// The relative errors under loads with one support.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HeldOutRecord {
    /// The groups that are held.
    pub support: String,
    /// Whether loads with this support were fitted.
    pub trained: bool,
    /// Whether loads with this support chose the regularization without being fitted.
    #[serde(default)]
    pub chooses: bool,
    /// The number of loads.
    pub loads: usize,
    /// The finite elements of the mesh, its exact networks, the network at the start, and the fitted one.
    pub models: Vec<ModelErrorRecord>,
    /// The loads whose errors the fitted network has more than a tenth larger than the finite elements of the mesh.
    #[serde(default)]
    pub worse_than_finite_elements: Vec<WorseLoadRecord>,
    /// Seconds of the same step of the finer body; null without one.
    pub seconds_per_step_fine: Option<f64>,
}

/// The relative errors `‖u − ū‖/‖ū‖` under a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorseLoadRecord {
    pub load: String,
    /// Of the finite elements of the mesh.
    pub finite_elements: f64,
    /// Of the fitted network.
    pub fitted: f64,
}

/// The relative errors `‖u − ū‖/‖ū‖` of a model; null if it is not stable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelErrorRecord {
    pub model: String,
    pub median: Option<f64>,
    pub worst: Option<f64>,
    pub worst_load: Option<String>,
    /// Seconds of a linear implicit step, which is one solution with a factor or levels that are there.
    pub seconds_per_step: Option<f64>,
}

impl HeldOutRecord {
    fn of(held_out: &HeldOut) -> HeldOutRecord {
        let model = |model: &ModelError| ModelErrorRecord {
            model: model.model.clone(),
            median: model.median,
            worst: model.worst,
            worst_load: model.worst_load.clone(),
            seconds_per_step: model.seconds_per_step,
        };
        let worse = |load: &WorseLoad| WorseLoadRecord {
            load: load.load.clone(),
            finite_elements: load.finite_elements,
            fitted: load.fitted,
        };
        HeldOutRecord {
            support: held_out.support.clone(),
            trained: held_out.part.is_fitted(),
            chooses: held_out.part.is_consulted(),
            loads: held_out.loads,
            models: held_out.models.iter().map(model).collect(),
            worse_than_finite_elements: held_out.worse.iter().map(worse).collect(),
            seconds_per_step_fine: held_out.seconds_fine,
        }
    }
}

/// A stage of the path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StageRecord {
    /// ρ.
    pub regularization: f64,
    /// The geometric mean of the relative errors on the loads of the validation, or on each load that was left out; null
    /// without validation, or if the network is not stable.
    pub validated: Option<f64>,
    /// The root mean square of the relative errors on the loads of the fit.
    pub trained: Option<f64>,
    /// The root mean square of the logarithms of the factors on the constants.
    pub change: f64,
    /// Whether it was rejected because of the range of its constants.
    pub rejected: bool,
    /// Whether its search ended by itself, and not at `iterations`.
    #[serde(default)]
    pub finished: bool,
    /// The objective at the start of the stage and after each step, of the residuals that were minimised last.
    #[serde(default)]
    pub objective: Vec<f64>,
}

/// The relative error under a load; null if the network is not stable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FittedLoadRecord {
    pub load: String,
    pub before: Option<f64>,
    pub after: Option<f64>,
}

/// The relative errors `ω_i/ω̄_i − 1` of the frequencies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrequencyErrorsRecord {
    pub before: Vec<Option<f64>>,
    pub after: Vec<Option<f64>>,
}

impl WholeRecord {
    pub(super) fn of(recipe: &WholeRecipe) -> WholeRecord {
        let objective = match &recipe.start {
            Start::Fit(fit) => Some(fit.objective),
            Start::Sampled(_) | Start::Equal | Start::Exact(..) => None,
        };
        WholeRecord {
            objective: "whole".into(),
            start: match &recipe.start {
                Start::Fit(fit) => StartRecord::Name(fit.objective.name().into()),
                Start::Sampled(recipe) => StartRecord::Sampled(Box::new(SampledRecord::of(recipe))),
                Start::Equal | Start::Exact(..) => StartRecord::Name(recipe.start.title()),
            },
            weight: objective.and_then(|objective| objective.weight()).map(|weight| weight.name().into()),
            higher: objective.and_then(|objective| objective.higher()),
            unknowns: recipe.unknowns.name().into(),
            residual: recipe.settings.residual.name().into(),
            solver: recipe.settings.method.name().into(),
            frequencies: recipe.frequencies,
            masses: recipe.masses,
            seed: recipe.seed,
            supports: recipe.supports.clone(),
            validate_supports: recipe.validation_supports.clone(),
            other_supports: recipe.other_supports.clone(),
        }
    }
}

impl WholeOutcomeRecord {
    /// The record of this outcome.
    pub fn of(outcome: &WholeOutcome) -> WholeOutcomeRecord {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let load = |load: &FittedLoad| FittedLoadRecord {
            load: load.name.clone(),
            before: finite(load.before),
            after: finite(load.after),
        };
        let stage = |(index, stage): (usize, &Stage)| StageRecord {
            regularization: stage.regularization,
            validated: outcome.left_out.get(index).copied().or(stage.validated).and_then(finite),
            trained: stage.trained,
            change: stage.change,
            rejected: stage.rejected,
            finished: stage.is_finished,
            objective: stage.objective.clone(),
        };
        let [before, after] = [0, 1].map(|i| outcome.frequencies[i].iter().map(|error| finite(*error)).collect());
        WholeOutcomeRecord {
            loads: outcome.loads.clone(),
            validated: outcome.validated.clone(),
            regularization: outcome.regularization,
            largest_change: finite(outcome.change),
            range: finite(outcome.range),
            limited_by_range: outcome.limited,
            curve: outcome.curve.iter().enumerate().map(stage).collect(),
            steps: outcome.steps,
            cancelled: outcome.cancelled,
            stands: outcome.stands,
            relative_errors_fitted: outcome.fitted.iter().map(load).collect(),
            relative_errors_validated: outcome.judged.iter().map(load).collect(),
            moduli: outcome.moduli.all.iter().map(FoundModulusRecord::of).collect(),
            hardly_seen: outcome.moduli.weak.clone(),
            misfit: outcome.moduli.misfit,
            held_out: outcome.held_out.iter().map(HeldOutRecord::of).collect(),
            relative_errors_of_frequencies: FrequencyErrorsRecord { before, after },
            masses: outcome.masses.as_ref().map(FittedMassesRecord::of),
        }
    }
}
