//! What a network answers in an engine that ends its iterations early: its effective stiffness at the settings of the engine, and how that
//! changes with the constants.
//!
//! An engine moves a body by substeps of length h. In each it predicts the points, `y = u + h v + h² W f` with the inverse masses W, and
//! corrects them by a fixed number N of sweeps. What comes to rest under the forces f is the body of the effective stiffness `K_N`,
//!
//! ```text
//! K_N (u + h² W f) = f
//! XPBD    K_N = Jᵀ P_N J/h²,    A = J W Jᵀ + diag(1/k)/h²     J: gradients of the measures, k: constants
//! VBD     K_N = M P_N K/h²,     A = K + M/h²                  M = W⁻¹
//! ```
//!
//! where `P_N` is what N sweeps apply in place of `A⁻¹`. `K_N` tends to the stiffness K of the network as N grows.
//!
//! | file | what it holds |
//! |---|---|
//! | `setting` | the settings of an engine, and those of engines by name |
//! | `sequence`, `order` | the order in which a sweep takes the springs or the points |
//! | `jolt` | the order of Jolt |
//! | `lanes` | displacements under several loads, which are swept together |
//! | `constraints` | XPBD: sweeps over the springs, and their derivatives |
//! | `descents` | VBD: sweeps over the points, and their derivatives |
//! | `truncated` | the effective stiffness: products, solutions, sensitivities |
//! | `model`, `growth` | what engines hold, and whether sweeps end |
//! | `vibration` | natural vibrations in an engine |
//! | `krylov` | solutions by GMRES, in memory that grows like the springs |
//! | `ceiling` | the largest stiffness that a setting reaches |
//! | `frames` | the steps of an engine, with the geometry as it moves |
//!
//! Theory: page *Networks in engines* of the book.

mod ceiling;
mod constraints;
mod descents;
mod frames;
mod growth;
mod history;
mod jolt;
mod krylov;
mod lanes;
mod model;
mod order;
mod sequence;
mod setting;
mod truncated;
mod vibration;

pub use ceiling::{Ceiling, least_substeps};
pub use frames::Frames;
pub use model::TruncatedModel;
pub use order::{colours, point_colours};
pub use sequence::Sequence;
pub use setting::{Engine, Order, Precision, Setting, Sweep};
pub use truncated::Truncated;
pub use vibration::Vibration;
