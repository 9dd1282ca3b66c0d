//! What a whole-object fit is to meet, and how it goes on.

use super::gauss_newton::GaussNewton;
use super::target::{Frequencies, Target};
use crate::model::Entries;

/// What minimises the objective.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    GaussNewton(GaussNewton),
    /// With so many pairs of steps and gradients.
    Lbfgs {
        memory: usize,
    },
}

/// Pairs that L-BFGS remembers.
const MEMORY: usize = 10;

crate::named!(Method { "gauss-newton" => GaussNewton { 0: GaussNewton::default() }, "l-bfgs" => Lbfgs { memory: MEMORY } });

/// What is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Residual {
    #[default]
    Displacements,
    /// See [`Balance`](super::Balance).
    Forces,
    /// Of forces at the largest ρ, then of displacements.
    ForcesFirst,
}

crate::named!(Residual { "displacements" => Displacements, "forces" => Forces, "forces-first" => ForcesFirst });

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
    pub const REGULARIZATIONS: [f64; 8] = [1e1, 1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
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

impl Validation {
    /// Of loads that are not fitted.
    pub fn loads(&self) -> &[Target] {
        match self {
            Validation::Loads(loads) => loads,
            Validation::None | Validation::LeaveOneOut => &[],
        }
    }
}

/// What is to be met: the loads of the fit, what chooses ρ, frequencies, and the stiffness of the finite elements where forces are
/// balanced.
#[derive(Debug, Clone, Default)]
pub struct Wanted {
    pub trained: Vec<Target>,
    pub validation: Validation,
    pub frequencies: Option<Frequencies>,
    pub body: Option<Entries>,
}
