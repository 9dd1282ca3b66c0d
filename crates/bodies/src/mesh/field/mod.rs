//! Displacements of a mesh's points from the files of measurements and of other programs.

mod displacements;
mod grid;
mod locator;
mod reading;
mod table;

pub use displacements::Field;
