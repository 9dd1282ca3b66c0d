//! Sweeps: a scene run for many values of its keys.

mod design;
mod entry;
mod range;
mod run;
mod studies;

pub use entry::SweepEntry;
pub use studies::{Study, Sweep};
