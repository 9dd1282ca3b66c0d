//! The experiments of a paper, run again: its printed tables and figures beside the computed ones.

mod index;
mod material;
mod outcome;
mod run;
mod surface;

pub use index::{Column, Index, file_stem, heading};
pub use outcome::{Paper, PaperRow, PaperTable, Surface};
pub use run::{check_experiments, run_paper, write_experiments};
