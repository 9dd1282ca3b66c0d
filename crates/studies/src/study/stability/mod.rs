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
mod usual;

pub use outcome::{Family, StabilityOutcome, StabilityRow, Verdict};
pub use scenes::stability_of_scene;
pub use usual::stability;
