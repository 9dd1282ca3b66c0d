//! The table `[sweep]` of a scene: which values its keys take in which studies.

mod design;
mod entry;
mod range;

pub use entry::SweepEntry;
