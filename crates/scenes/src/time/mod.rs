//! The behaviour of a scene in time: motions, natural frequencies, and moduli over frequency.
//!
//! Theory: page *Dynamics* of the book.

mod frequencies;
mod harmonic;
mod motion;
mod plan;
mod raised;
mod relaxing;

pub use plan::TimePlan;
pub use raised::{RELEASE, Raised};
