//! Spring constants from the displacements of the whole object: the network is fitted to move like the finite elements under a set
//! of loads, and judged under others.
//!
//! `min_θ Σ_l w_l ‖u_l − u_l^FEM‖²/‖u_l^FEM‖² + ρ mean_s (θ_s − θ_s⁰)²`, `θ_s = ln k_s`, `K(k) u_l = f_l`: constants stay positive,
//! and the second term keeps them near those of the elements.

mod descent;
mod loads;
mod problem;

pub use descent::{WholeFit, WholeSettings, fit_whole};
pub use loads::{NodalLoad, standard_loads};
pub use problem::{Problem, Target};
