//! Motion of a model whose mass is lumped at its points: `M ẍ + C ẋ + F(x) = f(t)`, some degrees of freedom prescribed.

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
mod motion;
mod resistance;
mod rest;
mod settle;
mod simulation;
mod solver;

pub use damping::{Dampers, Damping};
pub use drive::{Curve, Drive};
pub use integrator::Integrator;
pub use ledger::{Account, Balance};
pub use limit::largest_square;
pub use motion::{Motion, Options};
pub use settle::{Outcome, Step};
pub use simulation::{Simulation, State};
pub use solver::{LEAST_TOLERANCE, Solver};
