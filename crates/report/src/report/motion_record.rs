//! Motions in `report.json`.

use crate::dynamics::Integrator;
use crate::number::finite;
use crate::study::{DampingRecipe, ForcePrecision, ModelMotion, MotionEnding, MotionOutcome, Record};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The settings of a motion, with defaults resolved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionOptionsRecord {
    /// The motion takes this time in s.
    pub duration: f64,
    /// A step has this length in s.
    pub step: f64,
    /// The motion has this number of steps.
    pub steps: usize,
    /// The integrator has this name.
    pub integrator: String,
    /// The forces of springs are computed in this precision: `double` or `single`.
    #[serde(default = "double")]
    pub precision: String,
    /// Networks keep their stiffness at rest.
    pub linear: bool,
    /// A step takes at most this number of Newton's iterations; it is null where Newton's method is not used.
    pub iterations: Option<usize>,
    /// The equations of implicit steps are solved to this tolerance; it is null where Newton's method is not used.
    pub tolerance: Option<f64>,
    /// States are written this time in s apart.
    pub every: f64,
    /// This acceleration acts on all points, m/s²; the list is empty without gravity.
    pub gravity: Vec<f64>,
    /// Rayleigh's damping has these α in 1/s and β in s; it is null where a damping ratio is given.
    pub rayleigh: Option<[f64; 2]>,
    /// The damper parallel to each spring has this damping ratio. It is null if the scene gives no ratio.
    pub damping_ratio: Option<f64>,
    /// The mean displacement of this number of points is written.
    pub watched_points: usize,
}

/// The motion of a model, one number for each state that is written in its lists; null where a model has none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionRecord {
    /// The model is the fit of this name, or `finite elements`.
    pub name: String,
    /// This number of steps was made.
    pub steps: usize,
    /// The computation took this time in s.
    pub seconds: f64,
    /// The computation made this number of steps in a second.
    pub steps_per_second: Option<f64>,
    /// The motion is `complete`; `not solved` if all steps were made and the equations of some were not solved to the tolerance; `no
    /// response`, `ran away` or `not begun`.
    pub ended: String,
    /// A sentence says why the motion was not begun; it is null if it was.
    pub reason: Option<String>,
    /// This number of steps has equations that were not solved to the tolerance.
    pub unsolved_steps: usize,
    /// The fastest-growing motion of an unstable network grows at this rate at rest, 1/s.
    pub growth: Option<f64>,
    /// A point is displaced by this much at most in the states that are written, m.
    #[serde(default)]
    pub largest_displacement: Option<f64>,
    /// In one of a dozen states this number of cells is turned inside out, at a quadrature point or more.
    #[serde(default)]
    pub inverted_elements: usize,
    /// The states are at these times, s.
    pub time: Vec<Option<f64>>,
    /// The kinetic energy of each state is in J.
    pub kinetic: Vec<Option<f64>>,
    /// The elastic energy of each state is in J, beyond that at rest.
    pub elastic: Vec<Option<f64>>,
    /// Forces have done this work until each state, J.
    pub work: Vec<Option<f64>>,
    /// Damping has taken this energy until each state, J.
    pub dissipated: Vec<Option<f64>>,
    /// The method itself has made or lost this energy until each state, as a share of the largest energy.
    pub drift: Vec<Option<f64>>,
    /// The momentum of each state is in kg m/s, `[states][axes]`.
    pub momentum: Vec<Vec<Option<f64>>>,
    /// The angular momentum of each state about the origin is in kg m²/s, `[states][axes]`.
    pub angular_momentum: Vec<Vec<Option<f64>>>,
    /// The watched points have this mean displacement in each state, m, `[states][axes]`.
    pub watched: Vec<Vec<Option<f64>>>,
    /// The root mean square distance from the finite elements in each state is in percent of their largest displacement in the whole
    /// motion.
    pub e_rms: Vec<Option<f64>>,
    /// The mean of `e_rms` over time is in percent.
    pub e_rms_mean: Option<f64>,
    /// The largest `e_rms` is in percent.
    pub e_rms_max: Option<f64>,
    /// With springs that do not turn, the mean of `e_rms` is this, in percent. It is the share of the fit in the error where springs turn
    /// beside linear finite elements, and null elsewhere.
    pub linear_e_rms_mean: Option<f64>,
    /// With springs that do not turn, the largest `e_rms` is this, in percent; it is null as `linear_e_rms_mean` is.
    pub linear_e_rms_max: Option<f64>,
}

impl MotionRecord {
    /// Whether the motion says something of the body: it came to its end, and neither is the network unstable nor a cell inside out.
    pub fn is_trusted(&self) -> bool {
        self.ended == MotionEnding::Complete.name() && self.growth.is_none() && self.inverted_elements == 0
    }
}

/// Names the precision of the forces in reports without the key.
fn double() -> String {
    ForcePrecision::Double.name().into()
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
            integrator: options.method().into(),
            precision: recipe.precision.name().into(),
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
            largest_displacement: finite(model.largest),
            inverted_elements: model.inverted,
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
