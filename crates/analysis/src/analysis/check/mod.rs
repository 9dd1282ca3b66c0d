//! The proof of an element file: every property on which its use relies, with the number that was found.

mod inspection;
mod integrals;
mod property;
mod shape;
mod space;
mod springs;

pub use inspection::{Inspection, inspect};
pub use property::{Mark, Property};
pub use shape::spurious_modes;
