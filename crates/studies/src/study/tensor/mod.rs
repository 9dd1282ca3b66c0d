//! The elasticity tensor of a network, at next to no cost.

mod frame;
mod isotropic;
mod network_material;
mod piece;
mod relaxation;
mod sample;

pub use network_material::{NetworkMaterial, network_material};
