//! Equilibrium and natural vibrations of either model, and the stability of a network compared with the finite
//! elements.
//!
//! Theory: pages *Stiffness and the reduced space* and *Precision* of the book.

mod applied;
mod cholesky;
mod equations;
mod expectation;
mod harmonic;
mod inertia;
mod inflation;
mod internal;
mod known;
mod lanczos;
mod levels;
mod linear;
mod method;
mod modes;
mod newton;
mod ordering;
mod patterns;
mod positions;
mod stability;
mod stable;

pub use applied::Applied;
pub(crate) use cholesky::elimination_order;
pub use equations::Equations;
pub use expectation::{FactorCost, dense_rate, factor_cost, factor_cost_of};
pub use harmonic::Harmonic;
pub use inertia::Masses;
pub(crate) use internal::rounding;
pub use known::KnownEquations;
pub use levels::{Levels, Solved, compare_levels};
pub use linear::{Factor, System};
pub use method::{StaticMethod, StaticSolver};
pub(crate) use modes::generator;
pub use modes::{Modes, lowest_modes};
pub(crate) use newton::ROUGHEST;
pub use newton::{Ending, Equilibrium, Newton};
pub use patterns::KnownPatterns;
pub(crate) use positions::positions;
pub use springfit_numerics::dense::eigenvalues;
pub use stability::{Stability, Standing, compare_energies, is_definite};
