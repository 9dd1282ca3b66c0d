//! The finite elements and the networks of a scene over time.

use crate::dynamics::Account;
use crate::model::Deformation;
use crate::study::scene::MotionRecipe;

/// The motion of a scene's models.
#[derive(Debug, Clone)]
pub struct MotionOutcome {
    pub recipe: MotionRecipe,
    /// How many points are watched.
    pub watched: usize,
    /// The finite elements, if they move, then the networks.
    pub models: Vec<ModelMotion>,
}

/// How one model moved.
#[derive(Debug, Clone)]
pub struct ModelMotion {
    /// Of the fit, or "finite elements".
    pub name: String,
    /// Its place among the fits; `None` for the finite elements.
    pub fit: Option<usize>,
    pub steps: usize,
    /// For the steps, without what is written.
    pub seconds: f64,
    pub ending: MotionEnding,
    /// Steps whose equations were not solved to the tolerance.
    pub unsolved: usize,
    /// The largest of the finite elements at the records, where they are linear.
    pub deformation: Option<Deformation>,
    /// Of a network whose springs turn, the mean and largest error over the records where they do not, as the linear finite elements:
    /// what of the error is the fit's. `None` where the finite elements turn as well, or hardly.
    pub linear_error: Option<[f64; 2]>,
    /// Of a network that releases energy, how fast the fastest motion grows at rest, 1/s.
    pub growth: Option<f64>,
    pub records: Vec<Record>,
    /// Displacements at the records, `[points · dimension]`, m, where they are drawn.
    pub states: Vec<Vec<f64>>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum MotionEnding {
    Complete,
    /// The model had no response any more, as with a cell turned inside out.
    NoResponse,
    /// Numbers grew beyond all bounds.
    RanAway,
    /// No step could be made, and why.
    Refused(String),
}

/// A state that is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    pub account: Account,
    /// Mean displacement of the watched points, m; empty where none are.
    pub watched: Vec<f64>,
    /// Root mean square distance from the finite elements, in percent of their largest displacement in the whole motion.
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
    pub fn steps_per_second(&self) -> f64 {
        self.steps as f64 / self.seconds
    }

    /// Whether a state after the start is known.
    pub fn has_moved(&self) -> bool {
        self.records.len() > 1
    }

    /// Mean and largest error over the records.
    pub fn error(&self) -> Option<[f64; 2]> {
        let errors: Option<Vec<f64>> = self.records.iter().map(|record| record.error).collect();
        mean_and_largest(&errors?)
    }
}

/// `None` of none.
pub fn mean_and_largest(errors: &[f64]) -> Option<[f64; 2]> {
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    (!errors.is_empty()).then(|| [mean, errors.iter().copied().fold(0.0, f64::max)])
}

impl MotionEnding {
    pub fn name(&self) -> &'static str {
        match self {
            MotionEnding::Complete => "complete",
            MotionEnding::NoResponse => "no response",
            MotionEnding::RanAway => "ran away",
            MotionEnding::Refused(_) => "not begun",
        }
    }
}
