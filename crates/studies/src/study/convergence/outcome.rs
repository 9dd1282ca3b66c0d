//! The results of a convergence study.

use super::limit::{Limit, limit_of};
use serde::Serialize;

/// Errors that are this share of the truth or less are rounding.
const ROUNDING: f64 = 1e-9;

/// A scene on a sequence of meshes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Convergence {
    pub scene: String,
    /// Of the box around the body, m.
    pub extent: Vec<f64>,
    /// The title of the material's law; `None` at small deformation.
    pub law: Option<String>,
    /// The scene whose finite elements give the truth, where they are not those of the scene itself.
    pub reference: Option<String>,
    /// From the mesh of the scene on.
    pub levels: Vec<Level>,
    pub loads: Vec<LoadConvergence>,
}

/// One mesh of the sequence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Level {
    /// `h`, m: that of a cell of mean content on the first level, `(V / cells)^(1/d)`, halved from level to level.
    pub size: f64,
    pub cells: usize,
    pub points: usize,
    /// Directions of all points, held ones among them.
    pub unknowns: usize,
    /// To fit and to solve all models.
    pub seconds: f64,
}

/// What the models answer to one load on all levels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoadConvergence {
    pub name: String,
    /// The limit of the finite elements' compliance, J; `None` where they do not reach the load on some level.
    pub truth: Option<Limit>,
    /// The same of the mean displacement of the loaded part, m; `None` as well where it is prescribed.
    pub mean_truth: Option<Limit>,
    /// The finite elements, then each fit.
    pub models: Vec<ModelConvergence>,
}

/// One model under one load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelConvergence {
    pub name: String,
    /// `[levels]`.
    pub steps: Vec<Step>,
}

/// One model under one load on one level.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Step {
    /// Work of the load, `f·u`, or `u·r` with the reactions `r` to prescribed displacements, J; `None` where the model has no
    /// answer.
    pub compliance: Option<f64>,
    /// Of the loaded part, m.
    pub mean_displacement: Option<f64>,
    /// Of a network from the finite elements of the level, in percent, over all points.
    pub rms: Option<f64>,
    /// One word for the state of the model.
    pub status: &'static str,
}

impl LoadConvergence {
    /// With the truth that follows from the first of the models.
    pub fn new(name: String, models: Vec<ModelConvergence>) -> LoadConvergence {
        let body = models.first();
        let truth = body.and_then(ModelConvergence::limit);
        let means: Option<Vec<f64>> =
            body.and_then(|body| body.steps.iter().map(|step| step.mean_displacement).collect());
        let mean_truth = means.and_then(|means| limit_of(&means));
        LoadConvergence { name, truth, mean_truth, models }
    }

    /// The model's compliance against that of the finite elements of each level, in percent.
    pub fn of_body(&self, model: &ModelConvergence) -> Vec<Option<f64>> {
        let against = |(own, body): (&Step, &Step)| percent(own.compliance?, body.compliance?);
        model.steps.iter().zip(&self.models[0].steps).map(against).collect()
    }

    /// The model's compliance against the truth, in percent.
    pub fn of_truth(&self, model: &ModelConvergence) -> Vec<Option<f64>> {
        model.steps.iter().map(|step| percent(step.compliance?, self.truth?.value)).collect()
    }

    /// The model's mean displacement against the truth, in percent.
    pub fn mean_of_truth(&self, model: &ModelConvergence) -> Vec<Option<f64>> {
        model.steps.iter().map(|step| percent(step.mean_displacement?, self.mean_truth?.value)).collect()
    }
}

impl ModelConvergence {
    /// What the model's own compliance tends to; `None` where a level has no answer.
    pub fn limit(&self) -> Option<Limit> {
        let values: Option<Vec<f64>> = self.steps.iter().map(|step| step.compliance).collect();
        limit_of(&values?)
    }
}

/// `100 (value/of − 1)`; `None` where nothing is to be divided by, 0 where only rounding differs.
pub fn percent(value: f64, of: f64) -> Option<f64> {
    let share = (value - of) / of;
    share.is_finite().then_some(if share.abs() <= ROUNDING { 0.0 } else { 100.0 * share })
}

/// `log₂ |e_l / e_{l+1}|` from each level to the next, `[levels]`: none for the first, nor where an error is zero.
pub fn rates(errors: &[Option<f64>]) -> Vec<Option<f64>> {
    let rate = |pair: &[Option<f64>]| Some((pair[0]? / pair[1]?).abs().log2()).filter(|rate| rate.is_finite());
    std::iter::once(None).chain(errors.windows(2).map(rate)).collect()
}
