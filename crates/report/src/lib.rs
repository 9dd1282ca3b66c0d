//! What a person or a program reads of an outcome: tables, JSON, CSV, SVG and VTU files, and the record of the page.
//!
//! Users of springfit need not name this crate: the program writes its files.

#![forbid(unsafe_code)]

pub mod report;

// The layers below, by the same names as everywhere.
use springfit_bodies::{dynamics, model, solve};
use springfit_element::{element, material, springs};
use springfit_fit::fit;
use springfit_foundation::{error, file, number, order, scalar, symbolic, text};
use springfit_identify::positive;
use springfit_mesh::mesh;
use springfit_networks::network;
use springfit_studies::study;
