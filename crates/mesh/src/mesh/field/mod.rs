//! Displacements of the points of a mesh and numbers at places, read from files of measurements and of other programs.

mod columns;
mod displacements;
mod grid;
mod locator;
mod neighbours;
mod pieces;
mod raw;
mod reading;
mod rows;
mod samples;
mod scattered;
mod states;
mod table;

pub use displacements::Field;
pub use raw::Holder;
pub use samples::{Accepted, Interpolation, SampleReading, Samples};
pub use scattered::Scattered;
pub use states::NamedState;
