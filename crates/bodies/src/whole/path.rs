//! The path of regularizations, from strong to weak. Validation loads, which are not fitted, choose where it ends.
//!
//! Theory: page *Whole-object fits* of the book.

use super::balance::ResidualForces;
use super::descent::lbfgs;
use super::displacements::{Displacements, Errors};
use super::linearized::LeastSquares;
use super::object::Object;
use super::settings::{DescentMethod, Residual, Validation, Wanted, WholeSettings};
use crate::error::{Error, Result};
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
    /// Whether a better ρ was rejected because of its range of constants.
    pub limited: bool,
    /// The number of stages, once leave-one-out validation has chosen it.
    pub stages: Option<usize>,
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

/// The number of stages without improvement after which the path ends.
const PATIENCE: usize = 2;
/// The largest size of θ: no constant changes by more than the factor e¹⁰⁰.
const LARGEST: f64 = 100.0;

impl Snapshot {
    /// Checks the snapshot.
    ///
    /// # Errors
    /// It is not one of a fit with m unknowns and this number of stages.
    pub fn check(&self, m: usize, stages: usize) -> Result<()> {
        let fits = |theta: &[f64]| theta.len() == m && theta.iter().all(|t| t.abs() <= LARGEST);
        let known = |stage: Option<usize>| stage.is_none_or(|stage| stage < stages);
        if fits(&self.theta) && fits(&self.best.theta) && self.stage <= stages && known(self.best.stage) {
            return Ok(());
        }
        let expected = format!("the state of a fit with {m} unknowns and {stages} regularizations");
        Err(Error::expected("snapshot", expected, "another"))
    }
}

/// What does not change along the path.
pub(super) struct Path<'a> {
    pub object: &'a Object<'a>,
    pub wanted: &'a Wanted,
    pub settings: &'a WholeSettings,
}

impl Path<'_> {
    /// Continues from a snapshot until the validation shows no improvement, the path ends, or `watch` returns false.
    /// Returns the best result, which is that of the snapshot unless a stage was ended early.
    pub fn follow(
        &self,
        problem: &Displacements,
        judge: &Displacements,
        snapshot: &mut Snapshot,
        watch: &mut StepCallback,
    ) -> Result<Best> {
        let range = |theta: &[f64]| self.object.network(theta).range();
        let limit = self.settings.range.max(range(&vec![0.0; snapshot.theta.len()]));
        let stages = self.settings.regularizations.len();
        while snapshot.stage < snapshot.stages.unwrap_or(stages).min(stages) {
            let stage = snapshot.stage;
            let now = snapshot.clone();
            let mut goes_on = true;
            // A search that restarted in the middle of a stage would end elsewhere, so that stages are the units of
            // continuation.
            let mut visit = |_: &[f64], _: f64| {
                goes_on = watch(Some(&now));
                goes_on
            };
            problem.forget();
            judge.forget();
            let theta = self.stage(problem, stage, &snapshot.theta, &mut visit)?;
            let error = judge.errors(&theta)?.and_then(|errors| mean(&errors));
            let better = match (error, snapshot.best.error) {
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
            *snapshot = Snapshot { stage: stage + 1, theta, best, limited: better && wide, stages: snapshot.stages };
            // The largest ρ may keep the network too close to a start that happens to be good under some loads.
            if wide || snapshot.best.stage.is_some_and(|best| stage >= best + PATIENCE) {
                break;
            }
        }
        Ok(snapshot.best.clone())
    }

    fn stage(
        &self,
        problem: &Displacements,
        stage: usize,
        theta: &[f64],
        visit: &mut dyn FnMut(&[f64], f64) -> bool,
    ) -> Result<Vec<f64>> {
        let rho = self.settings.regularizations[stage];
        let mut theta = theta.to_vec();
        let forces = match self.settings.residual {
            Residual::Displacements => false,
            Residual::Forces => true,
            Residual::ForcesFirst => stage == 0 && theta.iter().all(|t| *t == 0.0),
        };
        if forces {
            let missing = || Error::expected("residual", "the stiffness of the finite elements for it", "none");
            let body = self.wanted.body.as_ref().ok_or_else(missing)?;
            let balance = ResidualForces::new(self.object, problem.targets.clone(), body)?;
            theta = self.descend(&balance, rho, &theta, visit)?;
        }
        match self.settings.residual {
            Residual::Forces => Ok(theta),
            _ => self.descend(problem, rho, &theta, visit),
        }
    }

    fn descend(
        &self,
        problem: &dyn LeastSquares,
        rho: f64,
        theta: &[f64],
        visit: &mut dyn FnMut(&[f64], f64) -> bool,
    ) -> Result<Vec<f64>> {
        let iterations = self.settings.iterations;
        match self.settings.method {
            DescentMethod::GaussNewton(method) => method.descend(problem, rho, theta, iterations, visit),
            DescentMethod::Lbfgs { memory } => lbfgs(problem, rho, theta, memory, iterations, visit),
        }
    }
}

/// The number of stages after which the error on loads that are left out, one at a time, is least; `None` if `watch`
/// returned false.
pub(super) fn leave_one_out(
    object: &Object,
    wanted: &Wanted,
    settings: &WholeSettings,
    watch: &mut StepCallback,
) -> Result<Option<usize>> {
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
            theta = path.stage(&problem, stage, &theta, &mut visit)?;
            if !goes_on {
                return Ok(None);
            }
            *sum += judge.errors(&theta)?.and_then(|errors| mean(&errors)).unwrap_or(f64::INFINITY);
        }
    }
    Ok((0..stages).min_by(|&a, &b| sums[a].total_cmp(&sums[b])).map(|stage| stage + 1))
}

/// The mean of the logarithms.
pub(super) fn mean(errors: &Errors) -> Option<f64> {
    let sum: f64 = errors.loads.iter().map(|e| e.ln()).sum();
    (!errors.loads.is_empty()).then(|| sum / errors.loads.len() as f64)
}
