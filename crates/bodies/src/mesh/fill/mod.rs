//! Fills a closed surface with the cells of a regular lattice.

mod columns;
mod filled;
mod filling;
mod lattice;
mod parts;
mod surface;

pub use filled::Filled;
pub use filling::FillMesh;
