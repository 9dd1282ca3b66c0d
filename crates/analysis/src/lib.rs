//! What elements and networks are, found by loops over cells and points that are worth optimising; studies call it.
//!
//! Users of springfit need not name this crate.

#![forbid(unsafe_code)]

pub mod analysis;

// The layers below, by the same names as everywhere.
use springfit_bodies::{model, solve};
use springfit_element::{element, material, springs, stiffness};
use springfit_fit::fit;
use springfit_foundation::{clock, error, named, number, random, scalar, symbolic};
use springfit_mesh::mesh;
