//! Bulk data of Nastran and its relatives (`.bdf`, `.nas`, `.dat`): grid points and elements.

mod bulk;
mod card;
mod cells;

pub use bulk::parse;
