//! Sweeps: a scene run for many values of its keys.

mod run;
mod studies;

pub use studies::{Study, Sweep};
