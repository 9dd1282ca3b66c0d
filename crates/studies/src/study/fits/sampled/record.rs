//! The settings of a sampled fit in a report.

use super::force::ForceRecipe;
use super::recipe::SampledRecipe;
use crate::fit::{DeformationFamily, Norm, Source};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The settings, with defaults filled in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "(sampled)")]
pub struct SampledRecord {
    /// The objective is `sampled`.
    pub objective: String,
    /// Shapes have the weights `relative` or `none`.
    pub weight: String,
    /// Forces that do no work on homogeneous deformations have this scale.
    pub higher: f64,
    /// All springs of a group have the same parameters.
    pub tied: bool,
    /// No parameter may be negative.
    pub nonnegative: bool,
    /// The springs have this law of force.
    pub force: ForceRecord,
    /// The residual forces are measured in this norm.
    pub norm: String,
    /// The Huber norm bends at this share; it is null with other norms.
    pub huber: Option<f64>,
    /// Parameters have these least and largest values, by name.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// The search begins at this number of points.
    pub starts: usize,
    /// The shapes are of these families of deformations; the list is null if they are from a file or from loads.
    pub families: Option<Vec<String>>,
    /// The amplitude is between these two.
    pub stretch: [f64; 2],
    /// Nodes are displaced at random by this share of the size of the cell.
    pub perturbation: f64,
    /// The random numbers have this seed.
    pub seed: u64,
    /// The forces of this energy are sampled; it is null if it is that of the material.
    pub law: Option<String>,
}

/// One force law for all springs, or one for each group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ForceRecord {
    All(String),
    Groups(BTreeMap<String, String>),
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
