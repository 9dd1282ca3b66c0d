//! Whole bodies: assembled models, solvers, and motion.
//!
//! Users of springfit need not name this crate: `springfit` names what they need of it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`model`] | the finite element model and the spring network of a mesh; loads, supports, masses |
//! | [`solve`] | equilibrium, natural vibrations, and whether a network is stable |
//! | [`dynamics`] | motion in time: integrators, damping, conservation of energy |
//! | [`engine`] | what a network answers in an engine that ends its iterations early |

#![forbid(unsafe_code)]

pub mod dynamics;
pub mod engine;
pub mod model;
pub mod solve;

// The layers below, by the same names as everywhere.
use springfit_element::{element, material, springs, stiffness};
use springfit_fit::fit;
use springfit_foundation::{clock, error, memory, named, number, range, scalar, symbolic};
use springfit_mesh::mesh;
