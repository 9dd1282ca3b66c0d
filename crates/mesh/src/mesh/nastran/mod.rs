//! Bulk data of Nastran and its relatives (`.bdf`, `.nas`, `.dat`, `.fem`): grid points and elements.

mod bulk;
mod card;
mod cells;
mod include;
mod middles;
mod properties;
mod systems;

pub use bulk::parse;
pub(super) use include::inclusion;
