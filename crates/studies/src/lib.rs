//! Scene files, and the studies that are made from them.
//!
//! Users of springfit need not name this crate: `springfit` names what they need of it.

#![forbid(unsafe_code)]

pub mod study;

// The layers below, by the same names as everywhere.
use springfit_analysis::analysis;
use springfit_bodies::{dynamics, engine, model, solve};
use springfit_element::{element, material, springs, stiffness};
use springfit_fit::fit;
use springfit_foundation::{bound, clock, error, file, named, number, order, quantity, random, range, scalar, text};
use springfit_identify::{calibration, whole};
use springfit_mesh::mesh;
