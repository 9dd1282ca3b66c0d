//! Whole bodies: assembled models, solvers, motion, and fits to the whole object.
//!
//! Users of springfit need not name this crate: `springfit` passes on its modules.
//!
//! | module | what it holds |
//! |---|---|
//! | [`model`] | the finite element model and the spring network of a mesh; loads, supports, masses |
//! | [`solve`] | equilibrium, natural vibrations, and whether a network is stable |
//! | [`dynamics`] | motion in time: integrators, damping, conservation of energy |
//! | [`engine`] | what a network answers in an engine that ends its iterations early |
//! | [`positive`] | the nearest network without negative springs to an exact network |
//! | [`whole`] | spring constants fitted to the displacements of the whole object |
//! | [`calibration`] | moduli of a body from measurements, with intervals |

#![forbid(unsafe_code)]

pub mod calibration;
pub mod dynamics;
pub mod engine;
pub mod model;
pub mod positive;
pub mod solve;
pub mod whole;

// The layers below, by the same names as everywhere.
use springfit_foundation::{clock, error, memory, named, number, range, scalar, symbolic};
use springfit_kernels::{element, fit, material, springs, stiffness};
use springfit_mesh::mesh;
