//! The settings and errors of a whole-object fit, as a report has them.

use super::outcome::{FittedLoad, WholeOutcome};
use super::recipe::{Start, WholeRecipe};
use crate::study::fits::sampled::SampledRecord;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings, with defaults resolved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WholeRecord {
    pub objective: String,
    pub start: StartRecord,
    /// Of the objective that it starts from, as `higher`.
    pub weight: Option<String>,
    pub higher: Option<f64>,
    /// What has a factor of its own: `spring`, `group`, `region` or `element`.
    pub unknowns: String,
    pub residual: String,
    pub solver: String,
    pub frequencies: usize,
    pub seed: u64,
}

/// The start: an objective or "equal", or the settings of a sampled fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum StartRecord {
    Name(String),
    Sampled(Box<SampledRecord>),
}

/// What the fit was fitted to, and how it ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WholeOutcomeRecord {
    pub loads: Vec<String>,
    pub validated: Vec<String>,
    /// Null if the start was best.
    pub regularization: Option<f64>,
    pub largest_change: Option<f64>,
    pub range: Option<f64>,
    pub limited_by_range: bool,
    pub steps: usize,
    pub cancelled: bool,
    pub stands: bool,
    pub relative_errors_fitted: Vec<FittedLoadRecord>,
    pub relative_errors_validated: Vec<FittedLoadRecord>,
    pub relative_errors_of_frequencies: FrequencyErrorsRecord,
}

/// The relative error under a load; null where the network does not stand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FittedLoadRecord {
    pub load: String,
    pub before: Option<f64>,
    pub after: Option<f64>,
}

/// `ω_i/ω̄_i − 1`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrequencyErrorsRecord {
    pub before: Vec<Option<f64>>,
    pub after: Vec<Option<f64>>,
}

impl WholeRecord {
    pub(super) fn of(recipe: &WholeRecipe) -> WholeRecord {
        let objective = match &recipe.start {
            Start::Fit(fit) => Some(fit.objective),
            Start::Sampled(_) | Start::Equal => None,
        };
        WholeRecord {
            objective: "whole".into(),
            start: match &recipe.start {
                Start::Fit(fit) => StartRecord::Name(fit.objective.name().into()),
                Start::Sampled(recipe) => StartRecord::Sampled(Box::new(SampledRecord::of(recipe))),
                Start::Equal => StartRecord::Name("equal".into()),
            },
            weight: objective.and_then(|objective| objective.weight()).map(|weight| weight.name().into()),
            higher: objective.and_then(|objective| objective.higher()),
            unknowns: recipe.unknowns.name().into(),
            residual: recipe.settings.residual.name().into(),
            solver: recipe.settings.method.name().into(),
            frequencies: recipe.frequencies,
            seed: recipe.seed,
        }
    }
}

impl WholeOutcomeRecord {
    pub fn of(outcome: &WholeOutcome) -> WholeOutcomeRecord {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let load = |load: &FittedLoad| FittedLoadRecord {
            load: load.name.clone(),
            before: finite(load.before),
            after: finite(load.after),
        };
        let [before, after] = [0, 1].map(|i| outcome.frequencies[i].iter().map(|error| finite(*error)).collect());
        WholeOutcomeRecord {
            loads: outcome.loads.clone(),
            validated: outcome.validated.clone(),
            regularization: outcome.regularization,
            largest_change: finite(outcome.change),
            range: finite(outcome.range),
            limited_by_range: outcome.limited,
            steps: outcome.steps,
            cancelled: outcome.cancelled,
            stands: outcome.stands,
            relative_errors_fitted: outcome.fitted.iter().map(load).collect(),
            relative_errors_validated: outcome.judged.iter().map(load).collect(),
            relative_errors_of_frequencies: FrequencyErrorsRecord { before, after },
        }
    }
}
