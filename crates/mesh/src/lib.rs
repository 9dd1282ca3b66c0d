//! Meshes: points, cells and named groups, and what is known at their points and cells.
//!
//! Users of springfit need not name this crate: `springfit` names what they need of it.

#![forbid(unsafe_code)]

pub mod mesh;

// The layers below, by the same names as everywhere.
use springfit_element::{element, springs, stiffness};
use springfit_foundation::{bound, error, file, named, number, quantity, random, range, symbolic, text};
