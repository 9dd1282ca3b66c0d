//! Whole bodies: meshes, assembled models, solvers, motion, and fits to the whole object.
//!
//! Users of springfit need not name this crate: `springfit` passes on its modules.
//!
//! | module | what it holds |
//! |---|---|
//! | [`mesh`] | points, cells and groups: read from Gmsh and VTK files, generated, refined, checked |
//! | [`model`] | the finite element model and the spring network of a mesh; loads, supports, masses |
//! | [`solve`] | equilibrium, natural vibrations, and whether a network is stable |
//! | [`dynamics`] | motion in time: integrators, damping, conservation of energy |
//! | [`positive`] | the nearest network without negative springs to an exact network |
//! | [`whole`] | spring constants fitted to the displacements of the whole object |

#![forbid(unsafe_code)]

pub mod dynamics;
pub mod mesh;
pub mod model;
pub mod positive;
pub mod solve;
pub mod whole;

// The layers below, by the same names as everywhere.
use springfit_foundation::{bound, error, file, memory, named, range, scalar, symbolic};
use springfit_kernels::{element, fit, material, springs, stiffness};
