//! The nearest network without negative springs to an exact one.
//!
//! A network of springs of rest length zero, `k_ab |x_a − x_b|²/2`, and of springs on content has the constants that its energy
//! has: some are below zero where angles are obtuse. What can be chosen is another network with
//!
//! ```text
//! k_ab ≥ 0,   Σ_b k_ab (X_b − X_a) as before at each point a
//! ```
//!
//! With the springs on content as they are, no point feels a force at rest, and as `Σ_b k_ab F (X_b − X_a)` is as before for every F,
//! the forces of every homogeneous deformation, small or large and under any law, are those of the exact network. Of all such
//! networks the one is taken whose constants change least while the energies of the lowest modes stay; a convex quadratic
//! programme. Where it has no solution, springs across the sides of simplices may be added. If that does not suffice, the tension of the
//! springs on content may change as well: then the forces of homogeneous deformations are near those of the exact network.
//!
//! Where all of this fails, only the network whose constants are all zero balances at rest without negative constants.

mod balance;
mod contents;
mod edges;
mod nearest;
mod outcome;
mod programme;
mod vibrations;

pub use nearest::{PositiveFit, nearest_positive};
pub use outcome::{PositiveOutcome, Route};
pub use programme::Watch;
