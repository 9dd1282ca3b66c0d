//! Fills a closed surface with the cells of a regular lattice.

mod bound;
mod columns;
mod filled;
mod filling;
mod grid;
mod lattice;
mod parts;
mod smooth;
mod snapping;
mod stencils;
mod surface;

pub use filled::Filled;
pub use filling::{FillBoundary, FillMesh};
