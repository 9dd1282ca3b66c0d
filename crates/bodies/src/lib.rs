//! Whole bodies: meshes, assembled models, solvers, motion, and fits to the whole object.

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
