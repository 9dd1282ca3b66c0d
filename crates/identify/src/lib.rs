//! What a whole body tells: spring constants from its displacements, the nearest network without negative springs, and moduli from
//! measurements.
//!
//! Users of springfit need not name this crate: `springfit` names what they need of it.
//!
//! | module | what it holds |
//! |---|---|
//! | [`positive`] | the nearest network without negative springs to an exact network |
//! | [`whole`] | spring constants fitted to the displacements of the whole object |
//! | [`calibration`] | moduli of a body from measurements, with intervals |

#![forbid(unsafe_code)]

pub mod calibration;
pub mod positive;
pub mod whole;

// The layers below, by the same names as everywhere.
use springfit_bodies::{engine, model, solve};
use springfit_element::{material, springs, stiffness};
use springfit_fit::fit;
use springfit_foundation::{error, memory, named};
use springfit_mesh::mesh;
