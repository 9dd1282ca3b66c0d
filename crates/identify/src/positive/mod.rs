//! The nearest network without negative springs to an exact network.
//!
//! A network of springs of rest length zero, `k_ab |x_a − x_b|²/2`, and of springs on content has constants that its
//! energy determines; some are negative where angles are obtuse. Another network can be chosen with
//!
//! ```text
//! k_ab ≥ 0,   Σ_b k_ab (X_b − X_a) as before at each point a
//! ```
//!
//! With unchanged springs on content, no point feels a force at rest; and since `Σ_b k_ab F (X_b − X_a)` is unchanged
//! for every F, the forces of every homogeneous deformation, small or large and under any law, are those of the exact
//! network. Of all such networks the one is chosen whose constants change least while the energies of the lowest modes
//! are kept; this is a convex quadratic programme. If it has no solution, springs across the sides of simplices may be
//! added. If that is not enough, the tension of the springs on content may change as well; the forces of homogeneous
//! deformations are then close to those of the exact network.
//!
//! If all of this fails, the only network in equilibrium at rest without negative constants is the one whose constants
//! are all zero.
//!
//! Theory: page *Exact networks and patches* of the book.

mod balance;
mod contents;
mod dual;
mod edges;
mod interior;
mod nearest;
mod outcome;
mod programme;
mod quadratic;
mod vibrations;

pub use nearest::{PositiveFit, nearest_positive};
pub use outcome::{PositiveOutcome, Route};
pub use quadratic::SearchProgress;
