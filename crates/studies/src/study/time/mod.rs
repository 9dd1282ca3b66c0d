//! What a scene does over time: motions and natural frequencies.

mod frequencies;
mod motion;
mod plan;
mod raised;

pub use plan::TimePlan;
