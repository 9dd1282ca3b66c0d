#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod aggregation;
mod assembly;
mod block;
mod bottom;
mod definiteness;
mod entry;
mod extreme;
mod fault;
mod galerkin;
mod gradients;
mod hierarchy;
mod level;
mod matrix;
mod parallel;
mod pattern;
mod prolongator;
mod random;
mod rigid;
mod settings;
mod smoother;
mod tentative;
mod tridiagonal;

// The tests of these parts are in the one binary of all tests, which reaches public items alone.
#[doc(hidden)]
pub mod parts {
    pub use crate::aggregation::Aggregates;
    pub use crate::block::{inverse, softest};
    pub use crate::tentative::{Tentative, tentative};
    pub use crate::tridiagonal::Tridiagonal;
}

pub use block::Block;
pub use definiteness::Definiteness;
pub use entry::WIDTH;
pub use extreme::{End, Extreme};
pub use fault::{Fault, Motion, sizes};
pub use gradients::Solution;
pub use hierarchy::{Multigrid, Workspace};
pub use matrix::BlockMatrix;
pub use pattern::{Groups, Pattern};
pub use rigid::{plane_motions, space_motions};
pub use settings::{Event, LevelSize, Settings, Watch, unwatched};
