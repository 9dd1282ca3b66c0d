//! The behaviour of a scene in time: motions and natural frequencies.
//!
//! Theory: page *Dynamics* of the book.

mod frequencies;
mod motion;
mod plan;
mod raised;
mod relaxing;

pub use plan::TimePlan;
pub(in crate::study) use raised::{RELEASE, Raised};
