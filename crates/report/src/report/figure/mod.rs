//! How figures are drawn for a paper, from the files that a run wrote.

mod axis;
mod camera;
mod cell;
mod chart;
mod convergence;
mod converter;
mod deformation;
mod format;
mod marks;
mod moduli;
mod palette;
mod precision;
mod run_folder;
mod shapes;
mod sheet;
mod swept;

pub use axis::Axis;
pub use chart::{Chart, Series, Shape};
pub use deformation::Deformation;
pub(super) use deformation::magnification;
pub use format::PictureFormat;
pub use moduli::{Moduli, ModulusCurve};
pub use run_folder::RunFolder;
pub use sheet::Columns;

pub(super) use cell::cell_picture;
pub(super) use chart::stacked;
pub(super) use convergence::{CONVERGENCE_TABLE, convergence_chart, convergence_charts};
pub(super) use palette::{COLORS, faded};
pub use precision::Cost;
pub(super) use precision::precision_chart;
pub(in crate::report) use sheet::{sheet, words};
pub(super) use swept::swept_chart;
