//! Moduli of a body from what was measured of it: `springfit calibrate`.
//!
//! Theory: page *Calibration* of the book.

mod meshes;
mod notes;
mod outcome;
mod readings;
mod regions;
mod run;

pub use outcome::{CalibratedLoad, CalibratedRegion, CalibrationOutcome, MeshStep, Value};
pub use readings::{Readings, Seen};
pub use run::{calibrate, calibrate_with};
