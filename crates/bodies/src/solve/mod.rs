//! Equilibrium and natural vibrations of either model, and the stability of a network compared with the finite
//! elements.
//!
//! Theory: pages *Stiffness and the reduced space* and *Precision* of the book.

mod cholesky;
mod expectation;
mod internal;
mod linear;
mod modes;
mod newton;
mod stability;

pub use expectation::{FactorCost, dense_rate, factor_cost};
pub use linear::{Factor, System};
pub(crate) use modes::generator;
pub use modes::{Modes, lowest_modes};
pub use newton::{Ending, Equilibrium, Newton};
pub use stability::{Stability, Standing, compare_energies};
