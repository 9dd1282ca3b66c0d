//! Fills a closed surface with the cells of a regular lattice.

mod bound;
mod columns;
mod crossings;
mod edges;
mod filled;
mod filling;
mod grid;
mod lattice;
mod layers;
mod parts;
mod place;
mod repair;
mod smooth;
mod snapping;
mod spacing;
mod stencils;
mod surface;
mod triangles;

pub use filled::{FaceCrossings, Filled};
pub use filling::{FillBoundary, FillMesh};
pub use layers::FillLayers;
pub use repair::{Fragments, Repair};
pub use spacing::FillSpacing;
