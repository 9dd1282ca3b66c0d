//! Lattices of springs by name, and their elasticity tensors as formulas. Theory: page *Lattices* of the book.

mod closed;
mod definition;
mod table;

pub use closed::ClosedTensor;
pub use definition::{Bond, NamedLattice, Root};
