//! The settings of a whole-object fit in a report.

use super::recipe::{Start, WholeRecipe};
use crate::fits::sampled::SampledRecord;
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
    /// The search steps by this method.
    pub solver: String,
    /// This number of natural frequencies is fitted.
    pub frequencies: usize,
    /// The masses are fitted to this number of natural frequencies after the springs.
    pub masses: usize,
    /// The random loads have this seed.
    pub seed: u64,
    /// Made loads are fitted under these supports, each a list of groups or conditions; the list is empty for that of the scene.
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
