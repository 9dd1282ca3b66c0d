//! Fills a closed surface with the cells of a regular lattice.

mod bound;
mod columns;
mod crossings;
mod filled;
mod filling;
mod grid;
mod lattice;
mod layers;
mod parts;
mod smooth;
mod snapping;
mod stencils;
mod surface;

pub use filled::{FaceCrossings, Filled};
pub use filling::{FillBoundary, FillMesh};
pub use layers::FillLayers;
