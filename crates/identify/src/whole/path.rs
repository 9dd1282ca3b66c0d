//! The path of regularizations, from strong to weak. Validation loads, which are not fitted, choose where it ends.
//!
//! Theory: page *Whole-object fits* of the book.

use super::balanced::Balanced;
use super::descent::{Descent, lbfgs};
use super::displacements::{Displacements, Errors};
use super::linearized::LeastSquares;
use super::object::Object;
use super::settings::{DescentMethod, Validation, Wanted, Weighing, WholeSettings};
use crate::error::{Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The state of a fit at the beginning of a stage. A run that continues from it makes the same steps to the same end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// The index of ρ among the regularizations.
    pub stage: usize,
    /// The unknowns θ.
    pub theta: Vec<f64>,
    /// The stage with the least error on the validation so far.
    pub best: Best,
    /// The finished stages.
    pub curve: Vec<Stage>,
    /// Once leave-one-out validation has chosen the number of stages, the mean relative error of each.
    pub left_out: Vec<f64>,
}

/// A finished stage: a point of the curve of errors against ρ, and of the L-curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct Stage {
    /// The stage has this regularization ρ.
    pub regularization: f64,
    /// The relative errors on the loads of the validation, or on each load that was left out, have this geometric mean; with `discrepancy`
    /// it is the residuals over the noise. It is null without validation, or if the network is not stable.
    pub validated: Option<f64>,
    /// The relative errors on the loads of the fit have this root mean square; it is null if the network is not stable.
    pub trained: Option<f64>,
    /// The logarithms of the factors on the constants have this root mean square.
    pub change: f64,
    /// The stage was left out because of the range of its constants.
    pub rejected: bool,
    /// The search ended by itself, and not at `iterations`.
    #[serde(rename = "finished", alias = "is_finished", default)]
    pub is_finished: bool,
    /// The objective has these values at the start of the stage and after each step. With L-BFGS the list has
    /// each lower point.
    #[serde(default)]
    pub objective: Vec<f64>,
}

/// The best of the finished stages.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Best {
    /// The mean logarithm of the relative errors; `None` before the first stage.
    pub error: Option<f64>,
    /// The unknowns θ of that stage.
    pub theta: Vec<f64>,
    /// Its index among the regularizations; `None` for the start.
    pub stage: Option<usize>,
}

/// A callback after each step, with the current state, or `None` during cross-validation. Returning false ends the fit.
pub type StepCallback<'a> = dyn FnMut(Option<&Snapshot>) -> bool + 'a;

/// The largest size of θ: no constant changes by more than the factor e¹⁰⁰. Its square is still far from overflow, and
/// no fit comes near it.
const LARGEST: f64 = 100.0;

impl Snapshot {
    /// Checks the snapshot.
    ///
    /// # Errors
    /// It is not one of a fit with m unknowns and this number of stages.
    pub fn check(&self, m: usize, stages: usize) -> Result<()> {
        let fits = |theta: &[f64]| theta.len() == m && theta.iter().all(|t| t.abs() <= LARGEST);
        let known = |stage: Option<usize>| stage.is_none_or(|stage| stage < stages);
        let counted = self.curve.len() <= stages && [0, stages].contains(&self.left_out.len());
        if fits(&self.theta) && fits(&self.best.theta) && self.stage <= stages && known(self.best.stage) && counted {
            return Ok(());
        }
        let expected = format!("the state of a fit with {m} unknowns and {stages} regularizations");
        Err(Error::expected("snapshot", expected, "another"))
    }

    /// The number of stages of the path: all, or those after which the error on loads that are left out is least.
    fn stages(&self, all: usize) -> usize {
        let least = (0..self.left_out.len()).min_by(|&a, &b| self.left_out[a].total_cmp(&self.left_out[b]));
        least.map_or(all, |stage| stage + 1)
    }

    /// Whether a stage with a smaller error than the best was rejected because of its range of constants.
    pub fn is_limited(&self) -> bool {
        // Errors of stages are stored as they are, and that of the best one as its logarithm.
        let best = self.best.error.map_or(f64::INFINITY, f64::exp);
        self.curve.iter().any(|stage| stage.rejected && stage.validated.is_none_or(|error| error < best))
    }
}

/// What does not change along the path.
pub(super) struct Path<'a> {
    pub object: &'a Object<'a>,
    pub wanted: &'a Wanted,
    pub settings: &'a WholeSettings,
}

impl Path<'_> {
    /// Continues from a snapshot to the end of the path, or until `watch` returns false. Returns the best result, which
    /// is that of the snapshot unless a stage was ended early.
    ///
    /// The error on the validation is not convex along the path: it can grow for several stages before it falls to its
    /// least value. No stage is therefore left out.
    pub fn follow(
        &self,
        problem: &Displacements,
        judge: &Displacements,
        snapshot: &mut Snapshot,
        watch: &mut StepCallback,
    ) -> Result<Best> {
        let range = |theta: &[f64]| self.object.range(theta);
        // A start beyond the range is not forbidden by it.
        let limit = self.settings.range.max(range(&vec![0.0; snapshot.theta.len()]));
        let stages = self.settings.regularizations.len();
        while snapshot.stage < snapshot.stages(stages) {
            let stage = snapshot.stage;
            let now = snapshot.clone();
            let mut goes_on = true;
            // A search that restarted in the middle of a stage would end elsewhere, so that stages are the units of
            // continuation.
            let mut visit = |_: &[f64], _: f64| {
                goes_on = watch(Some(&now));
                goes_on
            };
            // Each stage then depends on where it begins alone: a run that continues from a snapshot makes the same
            // steps.
            problem.forget();
            judge.forget();
            let Descent { theta, mut objective, is_finished } =
                self.stage(problem, stage, &snapshot.theta, &mut visit)?;
            // JSON has no infinity.
            objective.retain(|value| value.is_finite());
            let error = match self.wanted.validation {
                Validation::Discrepancy => self.excess(problem, &theta)?,
                Validation::None | Validation::Loads(_) | Validation::LeaveOneOut => {
                    judge.errors(&theta)?.and_then(|errors| mean(&errors))
                }
            };
            let better = match (error, snapshot.best.error) {
                // The first stage within the noise stays the best.
                (Some(_), Some(before)) if self.wanted.validation == Validation::Discrepancy => before > 0.0,
                (Some(now), Some(before)) => now < before,
                // Without validation each stage counts as better than the previous one.
                _ => snapshot.best.error.is_none(),
            };
            // A single requested ρ is used whatever its result is.
            let wide = self.wanted.validation != Validation::None && range(&theta) > limit;
            let best = if better && !wide {
                Best { error, theta: theta.clone(), stage: Some(stage) }
            } else {
                snapshot.best.clone()
            };
            if !goes_on {
                // The result counts, but the stage is not finished.
                return Ok(best);
            }
            let mut curve = std::mem::take(&mut snapshot.curve);
            curve.push(Stage {
                regularization: self.settings.regularizations[stage],
                validated: error.map(f64::exp),
                trained: problem.errors(&theta)?.and_then(|errors| root_mean_square(&errors.loads)),
                change: root_mean_square(&theta).unwrap_or(0.0),
                rejected: wide,
                is_finished,
                objective,
            });
            let left_out = std::mem::take(&mut snapshot.left_out);
            *snapshot = Snapshot { stage: stage + 1, theta, best, curve, left_out };
        }
        Ok(snapshot.best.clone())
    }

    /// The logarithm of the residuals at θ relative to the noise: not above zero where they are no larger.
    pub fn excess(&self, problem: &Displacements, theta: &[f64]) -> Result<Option<f64>> {
        let missing = || Error::expected("noise", "the size of the noise for its discrepancy", "none");
        let noise = self.wanted.noise.ok_or_else(missing)?;
        let Some(errors) = problem.errors(theta)? else { return Ok(None) };
        let square: f64 = errors.loads.iter().zip(&problem.targets).map(|(e, target)| target.weight * e * e).sum();
        // Half of the logarithm of a square is the logarithm itself, and zero where residuals are as large as the
        // noise.
        Ok(Some(0.5 * (square / (noise * noise * problem.observations() as f64)).ln()))
    }

    fn stage(
        &self,
        problem: &Displacements,
        stage: usize,
        theta: &[f64],
        visit: &mut dyn FnMut(&[f64], f64) -> bool,
    ) -> Result<Descent> {
        let rho = self.settings.regularizations[stage];
        let balanced = match self.settings.weighing {
            Weighing::Equal => None,
            Weighing::ByError => Balanced::at_errors(problem, theta)?,
        };
        match &balanced {
            Some(balanced) => self.descend(balanced, rho, theta, visit),
            None => self.descend(problem, rho, theta, visit),
        }
    }

    fn descend(
        &self,
        problem: &dyn LeastSquares,
        rho: f64,
        theta: &[f64],
        visit: &mut dyn FnMut(&[f64], f64) -> bool,
    ) -> Result<Descent> {
        let iterations = self.settings.iterations;
        match self.settings.method {
            DescentMethod::GaussNewton(method) => method.descend(problem, rho, theta, iterations, visit),
            DescentMethod::Lbfgs { memory } => lbfgs(problem, rho, theta, memory, iterations, visit),
        }
    }
}

/// The geometric mean of the relative errors on loads that are left out, one at a time, after each stage; empty if `watch`
/// returned false.
pub(super) fn leave_one_out(
    object: &Object,
    wanted: &Wanted,
    settings: &WholeSettings,
    watch: &mut StepCallback,
) -> Result<Vec<f64>> {
    let count = wanted.trained.len();
    if count < 2 {
        return Err(Error::expected("validate", "at least two loads to leave one out", count));
    }
    let stages = settings.regularizations.len();
    let mut sums = vec![0.0; stages];
    let path = Path { object, wanted, settings };
    for out in 0..count {
        let others = (0..count).filter(|l| *l != out).map(|l| &wanted.trained[l]).collect();
        let problem = Displacements::new(object, others, wanted.frequencies.as_ref())?;
        let judge = Displacements::new(object, vec![&wanted.trained[out]], None)?;
        let mut theta = vec![0.0; object.unknowns().count()];
        for (stage, sum) in sums.iter_mut().enumerate() {
            let mut goes_on = true;
            let mut visit = |_: &[f64], _: f64| {
                goes_on = watch(None);
                goes_on
            };
            theta = path.stage(&problem, stage, &theta, &mut visit)?.theta;
            // A mean over some of the loads could choose another stage.
            if !goes_on {
                return Ok(Vec::new());
            }
            // A stage at which one load loses its equilibrium is never the best.
            // A load without an equilibrium outweighs one that is met exactly, whose logarithm is −∞.
            *sum = match judge.errors(&theta)?.and_then(|errors| mean(&errors)) {
                Some(own) if *sum < f64::INFINITY => *sum + own,
                _ => f64::INFINITY,
            };
        }
    }
    // JSON has no infinity.
    Ok(sums.into_iter().map(|sum| (sum / count as f64).exp().min(f64::MAX)).collect())
}

/// The mean of the logarithms.
pub(super) fn mean(errors: &Errors) -> Option<f64> {
    let sum: f64 = errors.loads.iter().map(|e| e.ln()).sum();
    (!errors.loads.is_empty()).then(|| sum / errors.loads.len() as f64)
}

/// The root of the mean square.
fn root_mean_square(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt())
}
