//! Equilibrium of either model, and how the two compare mode by mode.

mod linear;
mod stability;

pub use linear::{Factor, System};
pub use stability::{Stability, Standing, compare_energies};
