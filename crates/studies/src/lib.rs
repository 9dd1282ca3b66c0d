//! Scene files, and the studies that are made from them.
//!
//! Users of springfit need not name this crate: `springfit` passes on its module [`study`].

#![forbid(unsafe_code)]

pub mod study;

// The layers below, by the same names as everywhere.
use springfit_analysis::analysis;
use springfit_bodies::{calibration, dynamics, engine, model, positive, solve, whole};
use springfit_foundation::{bound, clock, error, file, named, number, quantity, random, range, scalar, symbolic, text};
use springfit_kernels::{element, fit, material, springs, stiffness};
use springfit_mesh::mesh;
