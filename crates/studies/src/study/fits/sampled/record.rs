//! The settings and errors of a sampled fit in a report.

use super::force::ForceRecipe;
use super::outcome::SampledOutcome;
use super::recipe::SampledRecipe;
use crate::fit::{DeformationFamily, Norm, Source};
use crate::study::fits::spread::SpreadRecord;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The settings, with defaults filled in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampledRecord {
    /// The objective, `sampled`.
    pub objective: String,
    /// The weights of the shapes: `relative` or `none`.
    pub weight: String,
    /// The scale of the forces that do no work on homogeneous deformations.
    pub higher: f64,
    /// Whether all springs of a group have the same parameters.
    pub tied: bool,
    /// Whether no parameter may be negative.
    pub nonnegative: bool,
    /// The force law.
    pub force: ForceRecord,
    /// The norm of the residual forces.
    pub norm: String,
    /// The δ of the norm "huber", as a share.
    pub huber: Option<f64>,
    /// The bounds of parameters, by name.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// The number of starts of the search.
    pub starts: usize,
    /// The families of deformations; `None` if the shapes are from a file or from loads.
    pub families: Option<Vec<String>>,
    /// The least and the largest amplitude.
    pub stretch: [f64; 2],
    /// How far nodes are moved in addition, as a share of the size of the cell.
    pub perturbation: f64,
    /// The seed of the random numbers.
    pub seed: u64,
    /// The energy, if it is not that of the material.
    pub law: Option<String>,
}

/// One force law for all springs, or one for each group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ForceRecord {
    All(String),
    Groups(BTreeMap<String, String>),
}

/// The relative errors of the forces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampledOutcomeRecord {
    /// The number of shapes of the fit.
    pub shapes: usize,
    /// The errors on the shapes of the fit.
    pub trained: SpreadRecord,
    /// The errors on the shapes that were held out.
    pub held_out: Option<SpreadRecord>,
    /// The least share of starts that found the best parameters.
    pub agreeing_starts: Option<f64>,
    /// The loads of the scene whose shapes were sampled.
    pub loads: Vec<String>,
}

impl SampledRecord {
    /// The record of these settings.
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
                    Some(families.iter().map(DeformationFamily::name).map(String::from).collect())
                }
                Source::Families(_) | Source::Gradients(_) | Source::States(_) => None,
            },
            stretch: fit.sampling.stretch,
            perturbation: fit.sampling.perturbation,
            seed: fit.sampling.seed,
            law: recipe.law.clone().or_else(|| recipe.energy.as_ref().map(|energy| energy.name().into())),
        }
    }
}

impl SampledOutcomeRecord {
    /// The record of this outcome.
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
