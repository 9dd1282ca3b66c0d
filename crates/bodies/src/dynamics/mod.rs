//! Motion of a model with masses lumped at its points: `M ẍ + C ẋ + F(x) = f(t)`, with some degrees of freedom
//! prescribed.
//!
//! [`Simulation`] advances a [`Motion`] step by step with an [`Integrator`].
//!
//! Theory: page *Dynamics* of the book.

mod blocks;
mod damping;
mod drive;
mod equations;
mod factored;
mod gradients;
mod incomplete;
mod integrator;
mod ledger;
mod limit;
mod memory;
mod motion;
mod pass;
mod resistance;
mod rest;
mod rows;
mod settle;
mod simulation;
mod solver;
mod state;

pub use damping::{Dampers, Damping};
pub use drive::{Curve, Drive};
pub use integrator::Integrator;
pub use ledger::{Account, EnergyBalance};
pub use limit::{largest_square, largest_square_of_blocks};
pub use memory::{
    BranchForm, BranchTerm, Decay, ExplicitMemory, FlowMemory, LargeMemory, LinearMemory, Memory, RelaxingPart,
};
pub use motion::{Motion, Options};
pub use settle::{Step, StepOutcome};
pub use simulation::Simulation;
pub use solver::{LEAST_TOLERANCE, LinearSolver};
pub use state::MotionState;
