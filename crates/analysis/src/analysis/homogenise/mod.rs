//! The elasticity tensor of a network, whoever made it: of a body, of a part of it, of a network that repeats itself.
//!
//! All are `V C = Uᵀ K U − Fᵀ W`, with the stiffness K at rest, the unit strains U at the points, and the displacements W by which points
//! that are free give way to the forces `F = K U`. Theory: page *Lattices* of the book.

mod body;
mod elasticity;
mod lattice;
mod response;
mod tension;

pub use body::{affine, folded_entries, of_body, of_period, of_points, period_tensor};
pub use elasticity::{Elasticity, strain_names};
pub use lattice::{Bond, ClosedTensor, NamedLattice, Root};
pub use tension::Tension;
