//! What is promised in stiff and extreme cases, tried: each case ends accurate, limited by its input, or with its reason named.

mod bodies;
mod elements;
mod motions;
mod outcome;
mod scenes;
mod shapes;
mod sweep;

pub use outcome::{Family, StabilityOutcome, StabilityRow, Verdict};
pub use scenes::sweep_scene;
pub use sweep::sweep;
