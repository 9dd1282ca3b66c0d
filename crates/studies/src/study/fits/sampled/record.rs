//! The settings and errors of a sampled fit, as a report has them.

use super::force::ForceRecipe;
use super::outcome::SampledOutcome;
use super::recipe::SampledRecipe;
use crate::fit::{Family, Norm, Source};
use crate::study::fits::spread::SpreadRecord;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The settings, with defaults resolved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampledRecord {
    pub objective: String,
    /// How much each shape counts: `relative` or `none`.
    pub weight: String,
    pub higher: f64,
    pub tied: bool,
    pub nonnegative: bool,
    pub force: ForceRecord,
    pub norm: String,
    /// The share of the norm "huber".
    pub huber: Option<f64>,
    /// Of parameters by name.
    pub bounds: BTreeMap<String, [f64; 2]>,
    pub starts: usize,
    /// `None` if the shapes are from a file or from loads.
    pub families: Option<Vec<String>>,
    pub stretch: [f64; 2],
    pub perturbation: f64,
    pub seed: u64,
    pub law: Option<String>,
}

/// A law of force for all springs, or one for each group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ForceRecord {
    All(String),
    Groups(BTreeMap<String, String>),
}

/// How well the forces are met, as relative errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampledOutcomeRecord {
    pub shapes: usize,
    pub trained: SpreadRecord,
    pub held_out: Option<SpreadRecord>,
    /// The least share of starts that found the best parameters.
    pub agreeing_starts: Option<f64>,
    pub loads: Vec<String>,
}

impl SampledRecord {
    pub fn of(recipe: &SampledRecipe) -> SampledRecord {
        let fit = &recipe.fit;
        SampledRecord {
            objective: "sampled".into(),
            weight: fit.weights.name().into(),
            higher: fit.higher,
            tied: fit.tied,
            nonnegative: fit.nonnegative,
            force: match &recipe.force {
                ForceRecipe::Linear => ForceRecord::All("linear".into()),
                ForceRecipe::FreeRest => ForceRecord::All("free-rest".into()),
                ForceRecipe::Law(law) => ForceRecord::All(law.text.clone()),
                ForceRecipe::Groups(laws) => {
                    ForceRecord::Groups(laws.iter().map(|(group, law)| (group.clone(), law.text.clone())).collect())
                }
            },
            norm: fit.norm.name().into(),
            huber: if let Norm::Huber { share } = fit.norm { Some(share) } else { None },
            bounds: fit.bounds.iter().cloned().collect(),
            starts: fit.starts,
            families: match &fit.sampling.source {
                Source::Families(families) if recipe.loads.is_empty() => {
                    Some(families.iter().map(Family::name).map(String::from).collect())
                }
                Source::Families(_) | Source::Gradients(_) | Source::States(_) => None,
            },
            stretch: fit.sampling.stretch,
            perturbation: fit.sampling.perturbation,
            seed: fit.sampling.seed,
            law: recipe.law.clone(),
        }
    }
}

impl SampledOutcomeRecord {
    pub fn of(outcome: &SampledOutcome) -> SampledOutcomeRecord {
        SampledOutcomeRecord {
            shapes: outcome.shapes,
            trained: Some(outcome.trained).into(),
            held_out: outcome.held_out.map(|spread| Some(spread).into()),
            agreeing_starts: outcome.agreeing,
            loads: outcome.loads.clone(),
        }
    }
}
