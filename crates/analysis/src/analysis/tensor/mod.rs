//! The elasticity tensor of a network, measured on samples of its cells at little cost.

mod frame;
mod isotropic;
mod network_material;
mod owners;
mod piece;
mod relaxation;
mod sample;

pub(super) use isotropic::{basis, constants};
pub use network_material::most_samples;
pub use network_material::{NetworkMaterial, network_material};
pub use owners::SpringOwners;
