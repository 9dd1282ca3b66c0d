//! A sweep of ill-conditioned and extreme cases. Each result is accurate, limited by the accuracy of its input, or
//! refused with a reason.
//!
//! Theory: page *Precision* of the book.

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
