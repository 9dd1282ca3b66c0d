//! Code that computes the springs of a cell at run time.
//!
//! Users of springfit need not name this crate: `springfit` names what they need of it.

#![forbid(unsafe_code)]

pub mod generate;

// The layers below, by the same names as everywhere.
use springfit_element::{element, material, springs, stiffness};
use springfit_fit::fit;
use springfit_foundation::named::unknown;
use springfit_foundation::{error, scalar, symbolic, text};
