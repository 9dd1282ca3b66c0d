//! The proof of an element file: every property that its use relies on, with the figure found.

mod inspection;
mod integrals;
mod property;
mod shape;
mod space;
mod springs;

pub use inspection::{Inspection, inspect};
pub use property::{Mark, Property};
