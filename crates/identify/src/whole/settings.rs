//! The targets and settings of a whole-object fit.
//!
//! Theory: page *Whole-object fits* of the book.

use super::gauss_newton::GaussNewton;
use super::target::{Frequencies, Target};

/// The method that minimises the objective.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DescentMethod {
    /// Gauss–Newton steps within a trust region.
    GaussNewton(GaussNewton),
    /// L-BFGS.
    Lbfgs {
        /// The number of pairs of steps and gradients that it stores.
        memory: usize,
    },
}

/// The default number of pairs of L-BFGS.
// Numbers between 3 and 20 are usual (Nocedal and Wright 2006, section 7.2).
const MEMORY: usize = 10;

crate::named!(DescentMethod { "gauss-newton" => GaussNewton { 0: GaussNewton::default() }, "l-bfgs" => Lbfgs { memory: MEMORY } });

/// How much each load counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weighing {
    /// Each load counts as its target says.
    #[default]
    Equal,
    /// The less, the larger its error is where a stage begins, see [`Balanced`](super::Balanced).
    ByError,
}

/// The settings of a whole-object fit.
#[derive(Debug, Clone, PartialEq)]
pub struct WholeSettings {
    /// The values of ρ in order; each fit starts from the result of the previous one.
    pub regularizations: Vec<f64>,
    /// The largest number of steps with each ρ.
    pub iterations: usize,
    /// The method that minimises the objective.
    pub method: DescentMethod,
    /// How much each load counts, where the residuals are differences of displacements.
    pub weighing: Weighing,
    /// The largest ratio of the constants of two length springs. A ρ that leads to a larger one is rejected, unless the
    /// start has it.
    pub range: f64,
}

impl WholeSettings {
    /// The values of ρ if a validation chooses among them: one per power of ten, from almost no change to almost no
    /// regularization.
    pub const REGULARIZATIONS: [f64; 8] = [1e1, 1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
}

impl Default for WholeSettings {
    fn default() -> WholeSettings {
        WholeSettings {
            regularizations: WholeSettings::REGULARIZATIONS.to_vec(),
            iterations: 20,
            method: DescentMethod::GaussNewton(GaussNewton::default()),
            weighing: Weighing::default(),
            // The longest explicit step goes with the inverse root of the stiffest constant: it may become thirty times as short.
            range: 1e3,
        }
    }
}

/// How ρ is chosen.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Validation {
    /// The last one is used.
    #[default]
    None,
    /// The one with the least error on these loads, which are not fitted.
    Loads(Vec<Target>),
    /// The one with the least error on the loads of the fit, each left out once (Stone 1974).
    LeaveOneOut,
    /// The largest with which the residuals of the fit are no larger than the noise (Morozov 1966).
    Discrepancy,
}

impl Validation {
    /// The loads of the validation that are not fitted.
    pub fn loads(&self) -> &[Target] {
        match self {
            Validation::Loads(loads) => loads,
            Validation::None | Validation::LeaveOneOut | Validation::Discrepancy => &[],
        }
    }
}

/// The targets: the loads of the fit, the validation, and frequencies.
#[derive(Debug, Clone, Default)]
pub struct Wanted {
    /// The loads of the fit.
    pub trained: Vec<Target>,
    /// How ρ is chosen.
    pub validation: Validation,
    /// The target frequencies, if there are any.
    pub frequencies: Option<Frequencies>,
    /// The standard deviation of a residual, where the noise of the displacements is known; required by [`Validation::Discrepancy`].
    pub noise: Option<f64>,
}
