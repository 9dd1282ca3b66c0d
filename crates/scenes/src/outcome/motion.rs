//! The results of the motion of a scene.

use crate::dynamics::Account;
use crate::material::RelaxationTerm;
use crate::model::{Deformation, Support};
use crate::scene::MotionRecipe;

/// The motion of the models of a scene.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct MotionOutcome {
    /// The settings of the motion.
    pub recipe: MotionRecipe,
    /// The watched points.
    pub watched: Vec<usize>,
    /// The masses, `[points]`, kg.
    pub masses: Vec<f64>,
    /// The support of `[[fix]]`, and what is moved.
    pub support: Support,
    /// The forces over time.
    pub forces: Vec<TimedForce>,
    /// The displacements over time.
    pub pulls: Vec<TimedPull>,
    /// The terms in which stress relaxes, each with its region if regions relax unlike; none if it does not.
    pub relaxation: Vec<(Option<usize>, RelaxationTerm)>,
    /// The finite elements, if they move, then the networks.
    pub models: Vec<ModelMotion>,
}

/// A force over time in one direction, N: the curve is multiplied by the share of each point.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedForce {
    /// The direction, from 0.
    pub axis: usize,
    /// An expression in t.
    pub curve: String,
    /// Points with their shares; the shares of a force that is given in all add up to 1.
    pub shares: Vec<(usize, f64)>,
}

/// A displacement over time in one direction, m.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedPull {
    /// The direction, from 0.
    pub axis: usize,
    /// An expression in t, and in the x, y, z of the point at rest.
    pub curve: String,
    /// The points.
    pub points: Vec<usize>,
}

/// The motion of one model.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct ModelMotion {
    /// The name of the fit, or "finite elements".
    pub name: String,
    /// The index of the fit; `None` for the finite elements.
    pub fit: Option<usize>,
    /// The number of steps.
    pub steps: usize,
    /// The time for the steps, without output, s.
    pub seconds: f64,
    /// How the motion ended.
    pub ending: MotionEnding,
    /// The number of steps whose equations were not solved to the tolerance.
    pub unsolved: usize,
    /// The largest deformation of the finite elements at the records, if they are linear.
    pub deformation: Option<Deformation>,
    /// For a network whose springs rotate and that releases no energy: the mean and the largest error over the records of the same network with
    /// springs that do not rotate, as linear finite elements do not. This is the part of the error that the fit causes.
    /// `None` if the finite elements rotate as well, or hardly.
    pub linear_error: Option<[f64; 2]>,
    /// The growth rate at rest of the fastest motion of a network that releases energy, 1/s.
    pub growth: Option<f64>,
    /// The largest displacement of a point in the states that are written, m.
    pub largest: f64,
    /// The most cells that are inverted in one of a dozen states.
    pub inverted: usize,
    /// The states that are written.
    pub records: Vec<Record>,
    /// The displacements at the records, `[points · dimension]`, m, if pictures are requested.
    pub states: Vec<Vec<f64>>,
}

/// How a motion ended.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum MotionEnding {
    /// All steps were made, and their equations solved.
    #[default]
    Complete,
    /// All steps were made; the equations of some were not solved to the tolerance, see [`ModelMotion::unsolved`].
    Unsolved,
    /// The model has no response any more, for example because a cell is inverted.
    NoResponse,
    /// Numbers grew beyond all bounds.
    RanAway,
    /// No step could be made, for this reason.
    Refused(String),
}

/// A state that is written.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Record {
    /// Energy and momentum.
    pub account: Account,
    /// The mean displacement of the watched points, m; empty if there are none.
    pub watched: Vec<f64>,
    /// The root mean square distance from the finite elements, in percent of their largest displacement in the whole
    /// motion.
    pub error: Option<f64>,
}

impl Record {
    /// Whether all energies, momenta and displacements in it are finite.
    pub fn is_finite(&self) -> bool {
        let account = &self.account;
        let balance = account.balance.iter().flat_map(|b| [b.work, b.dissipated, b.drift]);
        let moved = account.momentum.iter().chain(&account.angular_momentum).chain(&self.watched).copied();
        [account.total()].into_iter().chain(balance).chain(moved).all(f64::is_finite)
    }
}

impl ModelMotion {
    /// The number of steps per second of computing time.
    pub fn steps_per_second(&self) -> f64 {
        self.steps as f64 / self.seconds
    }

    /// The mean and the largest error over the records.
    pub fn error(&self) -> Option<[f64; 2]> {
        let errors: Option<Vec<f64>> = self.records.iter().map(|record| record.error).collect();
        mean_and_largest(&errors?)
    }
}

/// The mean and the largest of the errors; `None` if there are none.
pub fn mean_and_largest(errors: &[f64]) -> Option<[f64; 2]> {
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    (!errors.is_empty()).then(|| [mean, errors.iter().copied().fold(0.0, f64::max)])
}

impl MotionEnding {
    /// The name in reports.
    pub fn name(&self) -> &'static str {
        match self {
            MotionEnding::Complete => "complete",
            MotionEnding::Unsolved => "not solved",
            MotionEnding::NoResponse => "no response",
            MotionEnding::RanAway => "ran away",
            MotionEnding::Refused(_) => "not begun",
        }
    }
}
