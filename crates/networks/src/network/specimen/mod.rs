//! Reads networks of anyone: files of springfit, PhysTwin, LAMMPS, MuJoCo, and tables of springs.

mod arrays;
mod file;
mod flex;
mod flex_places;
mod formats;
mod json;
mod lammps;
mod npz;
mod table;

pub use file::{SpecimenFile, SpecimenOptions};
pub use formats::{read_specimen, specimen_endings};
pub use table::{PointTable, read_points};
