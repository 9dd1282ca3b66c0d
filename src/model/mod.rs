//! The two models of one mesh, both as a sparse stiffness on the same degrees of freedom: finite elements, and springs.

mod load;
mod network;
mod support;
mod system;

pub use load::{Action, nodal_forces};
pub use network::{LengthSpring, MeasureSpring, Network};
pub use support::{Support, Unheld, unheld_bodies};
pub use system::{finite_elements, masses};

use faer::sparse::Triplet;

/// Entries of the lower triangle of a symmetric matrix; those of the same place add up.
pub type Entries = Vec<Triplet<usize, usize, f64>>;
