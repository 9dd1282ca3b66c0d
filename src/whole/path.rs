//! The path of regularizations, from much to little: how far it is followed is chosen by loads that the fit does not see.

use super::balance::Balance;
use super::descent::lbfgs;
use super::displacements::{Displacements, Errors};
use super::gauss_newton::GaussNewton;
use super::linearized::LeastSquares;
use super::object::Object;
use super::target::{Frequencies, Target};
use crate::error::{Error, Result};
use crate::model::{Entries, Network};
use serde::{Deserialize, Serialize};

/// What minimises the objective.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    GaussNewton(GaussNewton),
    /// With so many pairs of steps and gradients.
    Lbfgs {
        memory: usize,
    },
}

/// What is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Residual {
    #[default]
    Displacements,
    /// See [`Balance`].
    Forces,
    /// Of forces at the largest ρ, then of displacements.
    ForcesFirst,
}

/// How a whole-object fit goes on.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeSettings {
    /// Values of ρ from the first to the last, each started where the one before ended.
    pub regularizations: Vec<f64>,
    /// Steps with each.
    pub iterations: usize,
    pub method: Method,
    pub residual: Residual,
    /// A ρ with which a length spring becomes so many times as stiff as another is not taken, unless they are at the start.
    pub range: f64,
}

impl WholeSettings {
    /// Values of ρ where loads tell which of them is best.
    pub const REGULARIZATIONS: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
}

impl Default for WholeSettings {
    fn default() -> WholeSettings {
        WholeSettings {
            regularizations: WholeSettings::REGULARIZATIONS.to_vec(),
            iterations: 20,
            method: Method::GaussNewton(GaussNewton::default()),
            residual: Residual::default(),
            range: 1e3,
        }
    }
}

/// What chooses ρ.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Validation {
    /// The last one is taken.
    #[default]
    None,
    /// That of least error on these loads, which are not fitted.
    Loads(Vec<Target>),
    /// That of least error on the loads of the fit, each left out once (Stone 1974).
    LeaveOneOut,
}

/// Where a fit stands, to go on from later.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// The place of ρ among the regularizations.
    pub stage: usize,
    pub theta: Vec<f64>,
    /// Of least error on the validation so far.
    pub best: Best,
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

/// What a whole-object fit found.
#[derive(Debug, Clone)]
pub struct WholeFit {
    pub network: Network,
    /// The ρ that was taken; `None` where the start was best.
    pub regularization: Option<f64>,
    /// Of the loads of the fit and of frequencies, before and after.
    pub trained: [Errors; 2],
    /// Of the loads of the validation.
    pub validated: [Errors; 2],
    /// Steps that were made.
    pub steps: usize,
    /// The largest factor by which a constant changed.
    pub change: f64,
    /// The largest constant of a length spring, as a multiple of the least.
    pub range: f64,
    /// Whether it was ended before its time.
    pub cancelled: bool,
}

/// Told where the fit stands after each step, nothing while it tries what to leave out; ends it by returning false.
pub type Watch<'a> = dyn FnMut(Option<&Snapshot>) -> bool + 'a;

/// What is to be met: the loads of the fit, what chooses ρ, frequencies, and the stiffness of the finite elements where forces are
/// balanced.
#[derive(Debug, Clone, Default)]
pub struct Wanted {
    pub trained: Vec<Target>,
    pub validation: Validation,
    pub frequencies: Option<Frequencies>,
    pub body: Option<Entries>,
}

/// Fits the constants of the object. `from` is where an earlier run of the same fit stood.
///
/// # Errors
/// There is no load, the network does not stand, the snapshot is of another fit, or the equations do not fit into memory.
pub fn fit_whole(
    object: &Object,
    wanted: &Wanted,
    settings: &WholeSettings,
    from: Option<Snapshot>,
    watch: &mut Watch,
) -> Result<WholeFit> {
    let m = object.unknowns().count();
    if wanted.trained.is_empty() || settings.regularizations.is_empty() {
        return Err(Error::expected("loads", "at least one load and one regularization", "none"));
    }
    let none: &[Target] = &[];
    let judges = match &wanted.validation {
        Validation::Loads(loads) => &loads[..],
        _ => none,
    };
    let trained: Vec<&Target> = wanted.trained.iter().collect();
    let problem = Displacements::new(object, trained.clone(), wanted.frequencies.as_ref())?;
    let judge = Displacements::new(object, judges.iter().collect(), None)?;
    let start = vec![0.0; m];
    let trained_before = errors(&problem, &start)?;
    let validated_before = errors(&judge, &start)?;
    let stages = settings.regularizations.len();
    let mut steps = 0;
    let mut cancelled = false;
    let mut count = |snapshot: Option<&Snapshot>| {
        steps += 1;
        cancelled |= !watch(snapshot);
        !cancelled
    };
    let mut last = stages;
    if wanted.validation == Validation::LeaveOneOut {
        last = 1 + leave_one_out(object, wanted, settings, &mut count)?;
    }
    let path = Path { object, wanted, settings, last };
    let first = Best { error: mean(&validated_before), theta: start.clone(), stage: None };
    let snapshot = from.unwrap_or(Snapshot { stage: 0, theta: start, best: first });
    if snapshot.theta.len() != m || snapshot.best.theta.len() != m || snapshot.stage > stages {
        let expected = format!("a snapshot of this fit, with {m} unknowns");
        return Err(Error::expected("snapshot", expected, snapshot.theta.len()));
    }
    let last = path.follow(&problem, &judge, snapshot, &mut count)?;
    // What was ended early is gone on with from where it stood, what came to its end from there.
    let end = Snapshot { stage: if cancelled { last.stage } else { stages }, ..last };
    watch(Some(&end));
    let best = end.best;
    Ok(WholeFit {
        range: object.network(&best.theta).range(),
        network: object.network(&best.theta),
        regularization: best.stage.map(|stage| settings.regularizations[stage]),
        trained: [trained_before, errors(&problem, &best.theta)?],
        validated: [validated_before, errors(&judge, &best.theta)?],
        steps,
        change: object.unknowns().factors(&best.theta).into_iter().map(|c| c.max(1.0 / c)).fold(1.0, f64::max),
        cancelled,
    })
}

/// What stays the same along the regularizations.
struct Path<'a> {
    object: &'a Object<'a>,
    wanted: &'a Wanted,
    settings: &'a WholeSettings,
    /// Stages that are gone through at most.
    last: usize,
}

impl Path<'_> {
    /// Goes on from a snapshot until the judge sees no gain, the path ends, or `watch` says so.
    fn follow(
        &self,
        problem: &Displacements,
        judge: &Displacements,
        mut snapshot: Snapshot,
        watch: &mut Watch,
    ) -> Result<Snapshot> {
        while snapshot.stage < self.last {
            let (stage, best) = (snapshot.stage, snapshot.best.clone());
            let mut goes_on = true;
            let mut visit = |theta: &[f64], _: f64| {
                let now = Snapshot { stage, theta: theta.to_vec(), best: best.clone() };
                goes_on = watch(Some(&now));
                goes_on
            };
            let theta = self.stage(problem, stage, &snapshot.theta, &mut visit)?;
            if !goes_on {
                // The stage is not done: what it reached counts, but it is gone on with.
                snapshot.theta = theta.clone();
            }
            let error = judge.errors(&theta)?.and_then(|errors| mean(&errors));
            let better = match (error, best.error) {
                (Some(now), Some(before)) => now < before,
                // Without a judge each stage is better than the one before.
                _ => best.error.is_none(),
            };
            let range = |theta: &[f64]| self.object.network(theta).range();
            let better = better && range(&theta) <= self.settings.range.max(range(&vec![0.0; theta.len()]));
            if better {
                snapshot.best = Best { error, theta: theta.clone(), stage: Some(stage) };
            }
            if !goes_on {
                break;
            }
            (snapshot.theta, snapshot.stage) = (theta, stage + 1);
            if !better {
                break;
            }
        }
        Ok(snapshot)
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
            Residual::ForcesFirst => stage == 0,
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

/// The stage of least error on loads that are left out, one at a time.
fn leave_one_out(object: &Object, wanted: &Wanted, settings: &WholeSettings, watch: &mut Watch) -> Result<usize> {
    let count = wanted.trained.len();
    if count < 2 {
        return Err(Error::expected("validate", "at least two loads to leave one out", count));
    }
    let stages = settings.regularizations.len();
    let mut sums = vec![0.0; stages];
    let mut goes_on = true;
    let mut watch = |_: Option<&Snapshot>| {
        goes_on = goes_on && watch(None);
        goes_on
    };
    for out in 0..count {
        let others = (0..count).filter(|l| *l != out).map(|l| &wanted.trained[l]).collect();
        let problem = Displacements::new(object, others, wanted.frequencies.as_ref())?;
        let judge = Displacements::new(object, vec![&wanted.trained[out]], None)?;
        let mut theta = vec![0.0; object.unknowns().count()];
        for (stage, sum) in sums.iter_mut().enumerate() {
            let path = Path { object, wanted, settings, last: stage + 1 };
            let best = Best { error: None, theta: theta.clone(), stage: None };
            theta = path.follow(&problem, &judge, Snapshot { stage, theta, best }, &mut watch)?.theta;
            *sum += judge.errors(&theta)?.and_then(|errors| mean(&errors)).unwrap_or(f64::INFINITY);
        }
    }
    Ok((0..stages).min_by(|&a, &b| sums[a].total_cmp(&sums[b])).unwrap_or(0))
}

fn errors(problem: &Displacements, theta: &[f64]) -> Result<Errors> {
    problem
        .errors(theta)?
        .ok_or_else(|| Error::expected("springs", "a network that stands under every load", "one that does not"))
}

/// Of the logarithms.
fn mean(errors: &Errors) -> Option<f64> {
    let sum: f64 = errors.loads.iter().map(|e| e.ln()).sum();
    (!errors.loads.is_empty()).then(|| sum / errors.loads.len() as f64)
}
