//! The results of a convergence study.

use super::limit::{Limit, limit_of};
use serde::Serialize;

/// Relative errors up to this share are rounding. An order that is fitted to them would be that of noise.
const ROUNDING: f64 = 1e-9;

/// A scene on a sequence of meshes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Convergence {
    /// The title of the scene.
    pub scene: String,
    /// The size of the box around the body, m.
    pub extent: Vec<f64>,
    /// The title of the material's law; `None` at small deformation.
    pub law: Option<String>,
    /// The scene whose finite elements give the reference, if it is another one.
    pub reference: Option<String>,
    /// What must be known of the levels and the reference, one sentence each.
    pub notes: Vec<String>,
    /// The meshes, from that of the scene to the finest.
    pub levels: Vec<Level>,
    /// The results under each load.
    pub loads: Vec<LoadConvergence>,
}

/// One mesh of the sequence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Level {
    /// The cell size `h`, m. On the first level it is that of a cell of mean content, `(V/cells)^(1/d)`; it is halved
    /// from level to level.
    pub size: f64,
    /// The number of cells.
    pub cells: usize,
    /// The number of points.
    pub points: usize,
    /// The number of degrees of freedom, including held ones.
    pub unknowns: usize,
    /// The time to fit and solve all models, s.
    pub seconds: f64,
}

/// The results of the models under one load on all levels.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoadConvergence {
    /// The name of the load.
    pub name: String,
    /// Whether it prescribes displacements: the softer body does less work under it.
    pub is_prescribed: bool,
    /// The limit of the compliance of the finite elements, J; `None` if they do not reach the load on some level.
    pub truth: Option<Limit>,
    /// The limit of the mean displacement of the loaded part, m; `None` also if it is prescribed.
    pub mean_truth: Option<Limit>,
    /// The finite elements, then each fit.
    pub models: Vec<ModelConvergence>,
}

/// One model under one load.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelConvergence {
    /// The name of the fit, or `finite elements`.
    pub name: String,
    /// The results on the levels, `[levels]`.
    pub steps: Vec<Step>,
}

/// One model under one load on one level.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Step {
    /// The work of the load, `f·u`, or `u·r` with the reactions `r` to prescribed displacements, J; `None` if the model
    /// has no solution.
    pub compliance: Option<f64>,
    /// The mean displacement of the loaded part, m.
    pub mean_displacement: Option<f64>,
    /// The error of a network relative to the finite elements of the level, in percent, over all points.
    pub rms: Option<f64>,
    /// One word for the state of the model.
    pub status: &'static str,
}

impl LoadConvergence {
    /// The results of these models; the limits are those of the first one.
    pub fn new(name: String, is_prescribed: bool, models: Vec<ModelConvergence>) -> LoadConvergence {
        let body = models.first();
        let truth = body.and_then(ModelConvergence::limit);
        let means: Option<Vec<f64>> =
            body.and_then(|body| body.steps.iter().map(|step| step.mean_displacement).collect());
        let mean_truth = means.and_then(|means| limit_of(&means));
        LoadConvergence { name, is_prescribed, truth, mean_truth, models }
    }

    /// The error of the model's compliance relative to that of the finite elements of each level, in percent.
    pub fn of_body(&self, model: &ModelConvergence) -> Vec<Option<f64>> {
        let against = |(own, body): (&Step, &Step)| self.softer(own.compliance?, body.compliance?);
        model.steps.iter().zip(&self.models[0].steps).map(against).collect()
    }

    /// The error of the model's compliance relative to the limit, in percent.
    pub fn of_truth(&self, model: &ModelConvergence) -> Vec<Option<f64>> {
        model.steps.iter().map(|step| self.softer(step.compliance?, self.truth?.value)).collect()
    }

    /// By how many percent a body that does this work under the load is softer than one that does the other.
    pub fn softer(&self, work: f64, other: f64) -> Option<f64> {
        if self.is_prescribed { percent(other, work) } else { percent(work, other) }
    }

    /// The error of the model's mean displacement relative to the limit, in percent.
    pub fn mean_of_truth(&self, model: &ModelConvergence) -> Vec<Option<f64>> {
        model.steps.iter().map(|step| percent(step.mean_displacement?, self.mean_truth?.value)).collect()
    }
}

impl ModelConvergence {
    /// The limit of the model's own compliance; `None` if a level has no solution.
    pub fn limit(&self) -> Option<Limit> {
        let values: Option<Vec<f64>> = self.steps.iter().map(|step| step.compliance).collect();
        limit_of(&values?)
    }
}

/// `100 (value/of − 1)`; `None` if `of` is zero, 0 if the values differ only by rounding.
pub fn percent(value: f64, of: f64) -> Option<f64> {
    let share = (value - of) / of;
    share.is_finite().then_some(if share.abs() <= ROUNDING { 0.0 } else { 100.0 * share })
}

/// The observed orders `log₂ |e_l/e_{l+1}|`, `[levels]`: none for the first level, nor if an error is zero.
pub fn rates(errors: &[Option<f64>]) -> Vec<Option<f64>> {
    // Cells are halved from level to level, so that the order is a logarithm of base two.
    let rate = |pair: &[Option<f64>]| Some((pair[0]? / pair[1]?).abs().log2()).filter(|rate| rate.is_finite());
    std::iter::once(None).chain(errors.windows(2).map(rate)).collect()
}
