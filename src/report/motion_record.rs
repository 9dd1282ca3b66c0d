//! Motions in `report.json`.

use super::number::finite;
use crate::dynamics::Integrator;
use crate::study::{DampingRecipe, ModelMotion, MotionEnding, MotionOutcome, Record};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings of a motion, with defaults resolved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionOptionsRecord {
    /// s.
    pub duration: f64,
    /// s.
    pub step: f64,
    /// The number of time steps.
    pub steps: usize,
    /// The name of the integrator.
    pub integrator: String,
    /// Whether forces are linear in the displacements.
    pub linear: bool,
    /// Of Newton's method; null where it is not used, as `tolerance`.
    pub iterations: Option<usize>,
    /// Of the equations of implicit steps.
    pub tolerance: Option<f64>,
    /// s between the states that are written.
    pub every: f64,
    /// m/s²; empty for none.
    pub gravity: Vec<f64>,
    /// α, 1/s, and β, s.
    pub rayleigh: Option<[f64; 2]>,
    /// The damping ratio of each spring, where damping is given so.
    pub damping_ratio: Option<f64>,
    /// The number of points whose path is written.
    pub watched_points: usize,
}

/// The motion of a model, one number for each state that is written in its lists; null where a model has none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionRecord {
    /// Of the fit, or "finite elements".
    pub name: String,
    /// The steps that were computed.
    pub steps: usize,
    /// Time of the computation, s.
    pub seconds: f64,
    /// Steps in a second of computation.
    pub steps_per_second: Option<f64>,
    /// `complete`; `not solved` if that is so of the equations of some steps; `no response`, `ran away` or `not begun`.
    pub ended: String,
    /// Why the motion was not begun.
    pub reason: Option<String>,
    /// Implicit steps whose equations were not solved to the tolerance.
    pub unsolved_steps: usize,
    /// How fast the fastest motion grows at rest, 1/s, in a network that releases energy.
    pub growth: Option<f64>,
    /// s.
    pub time: Vec<Option<f64>>,
    /// J, as the three that follow.
    pub kinetic: Vec<Option<f64>>,
    /// Elastic energy at the recorded times, J.
    pub elastic: Vec<Option<f64>>,
    /// Work of the forces until then, J.
    pub work: Vec<Option<f64>>,
    /// Energy that the damping has taken, J.
    pub dissipated: Vec<Option<f64>>,
    /// As a share of the largest energy.
    pub drift: Vec<Option<f64>>,
    /// kg m/s, `[states][axes]`.
    pub momentum: Vec<Vec<Option<f64>>>,
    /// Angular momentum about the origin, kg m²/s.
    pub angular_momentum: Vec<Vec<Option<f64>>>,
    /// Mean displacement of the watched points, m.
    pub watched: Vec<Vec<Option<f64>>>,
    /// Percent of the largest displacement of the finite elements in the whole motion.
    pub e_rms: Vec<Option<f64>>,
    /// Mean over time of the root mean square error, percent of the largest displacement.
    pub e_rms_mean: Option<f64>,
    /// The largest of these errors.
    pub e_rms_max: Option<f64>,
    /// The same with springs that do not turn, where they turn beside linear finite elements: what of the error is the fit's.
    pub linear_e_rms_mean: Option<f64>,
    /// As `linear_e_rms_mean`, the largest.
    pub linear_e_rms_max: Option<f64>,
}

impl From<&MotionOutcome> for MotionOptionsRecord {
    fn from(motion: &MotionOutcome) -> MotionOptionsRecord {
        let recipe = &motion.recipe;
        let options = recipe.options;
        let is_newton = !options.linear && options.integrator != Integrator::SymplecticEuler;
        let (rayleigh, damping_ratio) = match recipe.damping {
            DampingRecipe::Rayleigh(pair) => (Some(pair), None),
            DampingRecipe::Ratio(ratio) => (None, Some(ratio)),
        };
        MotionOptionsRecord {
            duration: recipe.duration,
            step: options.step,
            steps: recipe.steps,
            integrator: options.integrator.name().into(),
            linear: options.linear,
            iterations: is_newton.then_some(options.iterations),
            tolerance: is_newton.then_some(options.tolerance),
            every: recipe.every,
            gravity: recipe.gravity.clone(),
            rayleigh,
            damping_ratio,
            watched_points: motion.watched.len(),
        }
    }
}

impl From<&ModelMotion> for MotionRecord {
    fn from(model: &ModelMotion) -> MotionRecord {
        let number = |of: &dyn Fn(&Record) -> Option<f64>| -> Vec<Option<f64>> {
            model.records.iter().map(|record| of(record).and_then(finite)).collect()
        };
        let numbers = |of: fn(&Record) -> &[f64]| -> Vec<Vec<Option<f64>>> {
            model.records.iter().map(|record| of(record).iter().map(|x| finite(*x)).collect()).collect()
        };
        MotionRecord {
            name: model.name.clone(),
            steps: model.steps,
            seconds: model.seconds,
            steps_per_second: if model.steps > 0 { finite(model.steps_per_second()) } else { None },
            ended: model.ending.name().into(),
            reason: if let MotionEnding::Refused(why) = &model.ending { Some(why.clone()) } else { None },
            unsolved_steps: model.unsolved,
            growth: model.growth.and_then(finite),
            time: number(&|r| Some(r.account.time)),
            kinetic: number(&|r| Some(r.account.kinetic)),
            elastic: number(&|r| Some(r.account.elastic)),
            work: number(&|r| r.account.balance.map(|b| b.work)),
            dissipated: number(&|r| r.account.balance.map(|b| b.dissipated)),
            drift: number(&|r| r.account.balance.map(|b| b.drift)),
            momentum: numbers(|r| &r.account.momentum),
            angular_momentum: numbers(|r| &r.account.angular_momentum),
            watched: numbers(|r| &r.watched),
            e_rms: number(&|r| r.error),
            e_rms_mean: model.error().and_then(|[mean, _]| finite(mean)),
            e_rms_max: model.error().and_then(|[_, max]| finite(max)),
            linear_e_rms_mean: model.linear_error.and_then(|[mean, _]| finite(mean)),
            linear_e_rms_max: model.linear_error.and_then(|[_, max]| finite(max)),
        }
    }
}
