//! Equilibrium and natural vibrations of either model, and how the two compare mode by mode.

mod cholesky;
mod internal;
mod levels;
mod linear;
mod method;
mod modes;
mod newton;
mod stability;

pub use levels::{Levels, Solved, compare_levels};
pub use linear::{Factor, System};
pub use method::{LinearMethod, LinearSolver};
pub(crate) use modes::generator;
pub use modes::{Modes, lowest_modes};
pub use newton::{Ending, Equilibrium, Newton};
pub use stability::{Stability, Standing, compare_energies};
