//! Networks as files. What is written for each spring is compiled here, optimised, as little else of a report is.
//!
//! Users of springfit need not name this crate.

#![forbid(unsafe_code)]

pub mod network;

// The layers below, by the same names as everywhere.
use springfit_bodies::{engine, model};
use springfit_element::{element, material, springs, stiffness};
use springfit_foundation::{error, file, number, symbolic, text};
use springfit_mesh::mesh;
