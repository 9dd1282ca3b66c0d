//! Moduli of a body from measured displacements and forces, with intervals that have the noise and the error of the mesh.
//!
//! The finite elements of a mesh, and of finer meshes of the same body, answer with displacements `u_h(θ)`. What is compared with the
//! measurements is their limit, extrapolated from the last two meshes,
//!
//! ```text
//! u(θ) = u_n + w c_1 + κ (c_1 − r c_0),     c_1 = u_n − u_{n−1},  c_0 = u_{n−1} − u_{n−2}
//! ```
//!
//! with w of the order of the elements, see [`Rest`].
//!
//! Theory: page *Calibration* of the book.

mod estimate;
mod field;
mod level;
mod limit;
mod neighbours;
mod sight;
mod unknowns;

pub use estimate::{Estimate, Fault, estimate};
pub use field::{FieldEstimate, Prior, estimate_field};
pub use level::{Laws, Level, LoadCase};
pub use limit::{Limit, Rest, clamped_order};
pub use sight::{Observation, Quantity};
pub use unknowns::{Asked, Unknown, Unknowns, poisson_of, ratio_of};
