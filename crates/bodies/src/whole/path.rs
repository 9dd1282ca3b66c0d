//! The path of regularizations, from much to little: how far it is followed is chosen by loads that the fit does not see.

use super::balance::Balance;
use super::descent::lbfgs;
use super::displacements::{Displacements, Errors};
use super::linearized::LeastSquares;
use super::object::Object;
use super::settings::{Method, Residual, Validation, Wanted, WholeSettings};
use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};

/// Where a fit stands at the beginning of a stage, to go on from later: with the same steps to the same end as without a break.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// The place of ρ among the regularizations.
    pub stage: usize,
    pub theta: Vec<f64>,
    /// Of least error on the validation so far.
    pub best: Best,
    /// Whether a ρ was better but its range too large.
    pub limited: bool,
    /// How many stages are gone through, where leaving loads out has told.
    pub stages: Option<usize>,
}

/// The best of the stages that are done.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Best {
    /// Mean logarithm of the relative errors; `None` before the first.
    pub error: Option<f64>,
    pub theta: Vec<f64>,
    /// Its place among the regularizations; `None` for the start.
    pub stage: Option<usize>,
}

/// Told where the fit stands after each step, nothing while it tries what to leave out; ends it by returning false.
pub type Watch<'a> = dyn FnMut(Option<&Snapshot>) -> bool + 'a;

/// Stages without a gain after which the path ends.
const PATIENCE: usize = 2;
/// No constant changes by more than the exponential of this.
const LARGEST: f64 = 100.0;

impl Snapshot {
    /// # Errors
    /// It is not one of a fit with m unknowns and so many stages.
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

/// What stays the same along the regularizations.
pub(super) struct Path<'a> {
    pub object: &'a Object<'a>,
    pub wanted: &'a Wanted,
    pub settings: &'a WholeSettings,
}

impl Path<'_> {
    /// Goes on from a snapshot until the judge sees no gain any more, the path ends, or `watch` says so; the best that was found,
    /// which is that of the snapshot unless a stage was ended early.
    pub fn follow(
        &self,
        problem: &Displacements,
        judge: &Displacements,
        snapshot: &mut Snapshot,
        watch: &mut Watch,
    ) -> Result<Best> {
        let range = |theta: &[f64]| self.object.network(theta).range();
        let limit = self.settings.range.max(range(&vec![0.0; snapshot.theta.len()]));
        let stages = self.settings.regularizations.len();
        while snapshot.stage < snapshot.stages.unwrap_or(stages).min(stages) {
            let stage = snapshot.stage;
            let now = snapshot.clone();
            let mut goes_on = true;
            // A search that began anew in the middle of a stage would come to another end: the stage is what is gone on with.
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
                // Without a judge each stage is better than the one before.
                _ => snapshot.best.error.is_none(),
            };
            // A ρ that was asked for is taken whatever comes of it.
            let wide = self.wanted.validation != Validation::None && range(&theta) > limit;
            let best = if better && !wide {
                Best { error, theta: theta.clone(), stage: Some(stage) }
            } else {
                snapshot.best.clone()
            };
            if !goes_on {
                // What is reached counts, but the stage is not done.
                return Ok(best);
            }
            *snapshot = Snapshot { stage: stage + 1, theta, best, limited: better && wide, stages: snapshot.stages };
            // The largest ρ may keep too near to a start that is good under some loads by chance.
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
            let balance = Balance::new(self.object, problem.targets.clone(), body)?;
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
            Method::GaussNewton(method) => method.descend(problem, rho, theta, iterations, visit),
            Method::Lbfgs { memory } => lbfgs(problem, rho, theta, memory, iterations, visit),
        }
    }
}

/// The number of stages after which the error on loads that are left out, one at a time, is least; `None` where `watch` ended it.
pub(super) fn leave_one_out(
    object: &Object,
    wanted: &Wanted,
    settings: &WholeSettings,
    watch: &mut Watch,
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

/// Of the logarithms.
pub(super) fn mean(errors: &Errors) -> Option<f64> {
    let sum: f64 = errors.loads.iter().map(|e| e.ln()).sum();
    (!errors.loads.is_empty()).then(|| sum / errors.loads.len() as f64)
}
