//! The constants of the springs of an element, from its stiffness, its forces at large deformation, or published formulas.
//!
//! Users of springfit need not name this crate: `springfit` names what they need of it.

#![forbid(unsafe_code)]

pub mod fit;

// The layers below, by the same names as everywhere.
use springfit_element::{element, material, springs, stiffness};
use springfit_foundation::{bound, error, named, number, random, range, scalar, symbolic};
