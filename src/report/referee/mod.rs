//! A referee of simulators: its record, its tables and its chart.

mod chart;
mod record;
mod tables;

pub use chart::referee_svg;
pub use record::{EngineRecord, Factor, FoundRow, RefereeRecord, RefereeRow, RepairRecord, Telling};
pub use tables::{referee_tables, referee_text};

use super::write_files;
use crate::error::Result;
use std::path::{Path, PathBuf};

/// What [`write_referee`] writes.
pub const REFEREE_FILES: [&str; 2] = ["referee.json", "referee.svg"];

/// Writes every number and the chart into `folder`, and returns the paths.
///
/// # Errors
/// The folder or a file cannot be written.
pub fn write_referee(record: &RefereeRecord, folder: &Path) -> Result<Vec<PathBuf>> {
    let [numbers, chart] = REFEREE_FILES;
    let text = serde_json::to_string_pretty(record).expect("keys are text") + "\n";
    write_files(folder, &[(numbers, text), (chart, referee_svg(record))])
}
