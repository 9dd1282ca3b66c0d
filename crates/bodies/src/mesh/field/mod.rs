//! Displacements of the points of a mesh, read from files of measurements and of other programs.

mod displacements;
mod grid;
mod locator;
mod reading;
mod table;

pub use displacements::Field;
