//! Fills a closed surface with the cells of a regular lattice.

mod columns;
mod filling;
mod lattice;
mod parts;
mod surface;

pub use filling::{FillMesh, Filled};
