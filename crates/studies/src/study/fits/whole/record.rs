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
#[schemars(title = "(whole)")]
pub struct WholeRecord {
    /// The objective is `whole`.
    pub objective: String,
    /// The fit starts from these constants.
    pub start: StartRecord,
    /// The objective of the start has this weight; it is null if the start has none.
    pub weight: Option<String>,
    /// Motions beyond constant strain have this scale in that weight; it is null without a modal weight.
    pub higher: Option<f64>,
    /// Springs share an unknown factor by `spring`, `group`, `region` or `element`, or the moduli of cells, regions or the body are the
    /// unknowns.
    pub unknowns: String,
    /// The residuals are those of `displacements`, `forces` or `forces-first`.
    pub residual: String,
    /// The search steps by this method.
    pub solver: String,
    /// This number of natural frequencies is fitted.
    pub frequencies: usize,
    /// The masses are fitted to this number of natural frequencies after the springs.
    pub masses: usize,
    /// The random loads have this seed.
    pub seed: u64,
    /// Made loads are fitted under these supports, each a list of groups; the list is empty for that of the scene.
    pub supports: Vec<Vec<String>>,
    /// Loads that choose the regularization have these supports; the list is empty for those of the fit.
    pub validate_supports: Vec<Vec<String>>,
    /// Loads that neither are fitted nor choose the regularization have these supports; their errors are reported.
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
    /// These loads were fitted.
    pub loads: Vec<String>,
    /// These loads chose the regularization.
    pub validated: Vec<String>,
    /// The regularization ρ was chosen; it is null if the start was best.
    pub regularization: Option<f64>,
    /// A constant changed by at most this factor.
    pub largest_change: Option<f64>,
    /// The largest constant of the length springs is this many times the least.
    pub range: Option<f64>,
    /// A better ρ was left out because the range would have been too large.
    pub limited_by_range: bool,
    /// Each entry is a stage of the path: the curve of errors against ρ.
    pub curve: Vec<StageRecord>,
    /// This number of steps was made.
    pub steps: usize,
    /// The fit was ended early.
    pub cancelled: bool,
    /// The starting network is stable under every load.
    pub stands: bool,
    /// Each entry has the relative errors on a load of the fit.
    pub relative_errors_fitted: Vec<FittedLoadRecord>,
    /// Each entry has the relative errors on a load that chose the regularization.
    pub relative_errors_validated: Vec<FittedLoadRecord>,
    /// Each entry is the factor on a modulus of the body or of its regions, if these are the unknowns.
    pub moduli: Vec<FoundModulusRecord>,
    /// These moduli have a 95 % interval that reaches beyond the factor 2: one alone, or several whose combination the displacements do not
    /// see.
    pub hardly_seen: Vec<String>,
    /// The residuals are this many times as large as the stated noise; it is null where no `sigma` is given.
    pub misfit: Option<f64>,
    /// Each entry has the errors of a support under loads that were neither fitted nor chose ρ. The list is empty without `[reference]` and
    /// `supports`, and with measured displacements.
    pub held_out: Vec<HeldOutRecord>,
    /// `relative_errors_of_frequencies` has the relative errors of the frequencies before and after.
    pub relative_errors_of_frequencies: FrequencyErrorsRecord,
    /// `masses` has the fit of the masses; it is null unless the scene asks for `masses`.
    pub masses: Option<FittedMassesRecord>,
}

/// Masses that were fitted to frequencies. The masses themselves are in the file of the network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FittedMassesRecord {
    /// This number of frequencies was fitted under each support.
    pub frequencies: usize,
    /// The regularization ρ was chosen.
    pub regularization: f64,
    /// The second moments `Σ m x_k²` about the centre have at most this error, relative to those of the body. It is none, or that of lumped
    /// masses.
    pub second_moment_error: f64,
    /// A mass changed by at most this factor.
    pub largest_change: f64,
    /// The sum of the masses is in kg.
    pub total: f64,
    /// Lumped masses have this share s in the mass matrix `(1 − s) M_c + s diag(m)`; M_c is the consistent one.
    #[serde(default)]
    pub lumped_share: f64,
    /// Each entry has the errors of the frequencies with one ρ.
    pub curve: Vec<MassStageRecord>,
    /// Each entry has the errors of the frequencies under a support.
    pub supports: Vec<SupportFrequenciesRecord>,
}

/// A point of the curve of errors of frequencies against ρ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MassStageRecord {
    /// The stage has this regularization ρ.
    pub regularization: f64,
    /// The frequencies that were fitted have this root mean square error.
    pub trained: f64,
    /// The frequencies that chose ρ have this root mean square error; it is null where none choose.
    pub validated: Option<f64>,
}

/// The errors of frequencies under a support.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SupportFrequenciesRecord {
    /// These groups are held.
    pub support: String,
    /// The first frequencies were fitted.
    pub trained: bool,
    /// The frequencies chose the regularization without being fitted.
    #[serde(default)]
    pub chooses: bool,
    /// The entries are the finite elements of the mesh and the fitted network with lumped masses, and the fitted network with fitted masses
    /// and with the mass matrix.
    pub models: Vec<ModelFrequenciesRecord>,
}

/// The root mean squares of the relative errors `ω_i/ω̄_i − 1` of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelFrequenciesRecord {
    /// The model is `finite elements`, `fitted`, `fitted masses` or `mass matrix`.
    pub model: String,
    /// This is the root mean square of `ω_i/ω̄_i − 1` over as many first frequencies as were fitted.
    pub first: f64,
    /// This is the root mean square of `ω_i/ω̄_i − 1` over as many frequencies after the first, which no fit has seen.
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
    /// The modulus is `mu` or `lambda`, with its region.
    pub modulus: String,
    /// The modulus of the material is multiplied by this factor.
    pub factor: f64,
    /// The factor is in this interval with 95 %; it is null if the displacements do not determine it, or if an end is beyond all numbers.
    pub interval: Option<[f64; 2]>,
    /// The meshes cause this standard deviation of the logarithm of the factor, which is in the interval; it is null without a finer body.
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
    /// These groups are held.
    pub support: String,
    /// Loads with this support were fitted.
    pub trained: bool,
    /// Loads with this support chose the regularization without being fitted.
    #[serde(default)]
    pub chooses: bool,
    /// The support has this number of loads, none of which was fitted or chose ρ.
    pub loads: usize,
    /// The entries are the finite elements of the mesh, its exact networks, the network at the start, and the fitted one.
    pub models: Vec<ModelErrorRecord>,
    /// Each entry is a load whose error is more than a tenth larger with the fitted network than with the finite elements of the mesh.
    #[serde(default)]
    pub worse_than_finite_elements: Vec<WorseLoadRecord>,
    /// A linear implicit step of the finer body takes this time in s; it is null without one.
    pub seconds_per_step_fine: Option<f64>,
}

/// The relative errors `‖u − ū‖/‖ū‖` under a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WorseLoadRecord {
    /// The load has this name.
    pub load: String,
    /// The finite elements of the mesh have this relative error `‖u − ū‖/‖ū‖`.
    pub finite_elements: f64,
    /// The fitted network has this relative error `‖u − ū‖/‖ū‖`.
    pub fitted: f64,
}

/// The relative errors `‖u − ū‖/‖ū‖` of a model; null if it is not stable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelErrorRecord {
    /// The model is `finite elements`; `exact`, `exact patches` and `exact edges patches` where the mesh has them; `start`, where the
    /// moduli of the body are fitted already; or `fitted`.
    pub model: String,
    /// The relative errors `‖u − ū‖/‖ū‖` have this median; it is null if the model is not stable.
    pub median: Option<f64>,
    /// The largest relative error `‖u − ū‖/‖ū‖` is this; it is null if the model is not stable.
    pub worst: Option<f64>,
    /// The largest error is under this load.
    pub worst_load: Option<String>,
    /// A linear implicit step takes this time in s: one solution with a factor or levels that are there.
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
    /// The stage has this regularization ρ.
    pub regularization: f64,
    /// The relative errors on the loads of the validation, or on each load that was left out, have this geometric mean; with `discrepancy`
    /// it is the residuals over the noise. It is null without validation, or if the network is not stable.
    pub validated: Option<f64>,
    /// The relative errors on the loads of the fit have this root mean square.
    pub trained: Option<f64>,
    /// The logarithms of the factors on the constants have this root mean square.
    pub change: f64,
    /// The stage was left out because of the range of its constants.
    pub rejected: bool,
    /// The search ended by itself, and not at `iterations`.
    #[serde(default)]
    pub finished: bool,
    /// The objective has these values at the start of the stage and after each step. With `forces-first` it is that of the displacements,
    /// and with L-BFGS the list has each lower point.
    #[serde(default)]
    pub objective: Vec<f64>,
}

/// The relative error under a load; null if the network is not stable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FittedLoadRecord {
    /// The load has this name.
    pub load: String,
    /// The displacements have this relative error before the fit.
    pub before: Option<f64>,
    /// The displacements have this relative error after the fit.
    pub after: Option<f64>,
}

/// The relative errors `ω_i/ω̄_i − 1` of the frequencies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrequencyErrorsRecord {
    /// The frequencies have the relative errors `ω_i/ω̄_i − 1` before the fit.
    pub before: Vec<Option<f64>>,
    /// The frequencies have the relative errors `ω_i/ω̄_i − 1` after the fit.
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
