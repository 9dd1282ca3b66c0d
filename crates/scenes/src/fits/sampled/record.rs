//! The settings of a sampled fit in a report.

use super::force::ForceRecipe;
use super::origin::ShapeOrigin;
use super::recipe::SampledRecipe;
use crate::fit::{DeformationFamily, Norm, Sampling, Source};
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
    /// The residual forces are measured in this norm, or by the function of this name.
    pub norm: String,
    /// The Huber norm bends at this share; it is null with other norms.
    pub huber: Option<f64>,
    /// Parameters have these least and largest values, by name.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// The search begins at this number of points.
    pub starts: usize,
    /// The springs are fitted to the shapes of these sets.
    pub shapes: Vec<ShapesRecord>,
    /// The forces of this energy are sampled; it is null if it is that of the material.
    pub law: Option<String>,
}

/// A set of shapes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShapesRecord {
    /// The shapes are from `families`, `gradients`, `loads`, `states` or a `run`.
    pub from: String,
    /// The shapes are of these families of deformations; the list is null if they are from elsewhere.
    pub families: Option<Vec<String>>,
    /// The axes of the families are along these directions; the list is empty if they are random.
    pub directions: Vec<Vec<f64>>,
    /// Amplitudes and axes are the points of this design.
    pub design: String,
    /// The amplitude is between these two.
    pub stretch: [f64; 2],
    /// This number of shapes is used at most.
    pub count: usize,
    /// This number of other shapes of the same source is held out at most; it is null if `others` are.
    pub held_out: Option<usize>,
    /// These shapes are held out in place of those; they are null if there are none.
    pub others: Option<Box<ShapesRecord>>,
    /// Nodes are displaced at random by this share of the size of the cell.
    pub perturbation: f64,
    /// The random numbers have this seed.
    pub seed: u64,
    /// All shapes of the set together have this weight.
    pub weight: f64,
}

impl ShapesRecord {
    fn of(sampling: &Sampling, origin: &ShapeOrigin) -> ShapesRecord {
        let others = sampling.others.as_deref().zip(origin.others.as_deref());
        ShapesRecord {
            from: origin.word().into(),
            families: match &sampling.source {
                Source::Families(families) if origin.word() == "families" => {
                    Some(families.iter().map(DeformationFamily::name).map(String::from).collect())
                }
                Source::Families(_) | Source::Gradients(_) | Source::States(_) => None,
            },
            directions: sampling.directions.clone(),
            design: sampling.design.name().into(),
            stretch: sampling.stretch,
            count: sampling.shapes,
            held_out: sampling.others.is_none().then_some(sampling.held_out),
            others: others.map(|(others, origin)| Box::new(ShapesRecord::of(others, origin))),
            perturbation: sampling.perturbation,
            seed: sampling.seed,
            weight: sampling.weight,
        }
    }
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
            norm: fit.objective.as_ref().map_or(fit.norm.name(), |objective| objective.name()).into(),
            huber: if let Norm::Huber { share } = fit.norm { Some(share) } else { None },
            bounds: fit.bounds.iter().cloned().collect(),
            starts: fit.starts,
            shapes: fit.sets().zip(&recipe.origins).map(|(set, origin)| ShapesRecord::of(set, origin)).collect(),
            law: recipe.law.clone().or_else(|| recipe.energy.as_ref().map(|energy| energy.name().into())),
        }
    }
}
