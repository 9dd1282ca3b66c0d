//! What elements and networks are: whether an element file holds what its use relies on, the moduli and the elasticity tensor of a network,
//! and how far displacements are from each other.

pub mod check;
pub mod homogenise;
pub mod locking;
pub mod metrics;
pub mod moduli;
pub mod shapes;
pub mod statistics;
pub mod tensor;
