//! A referee of simulators: its record, its tables and its chart.

mod chart;
mod record;
mod tables;

pub use chart::referee_svg;
pub use record::{EngineRecord, Factor, FoundRow, RefereeRecord, RefereeRow, RepairRecord, Telling};
pub use tables::{referee_tables, referee_text};

use super::write_files;
use crate::error::Result;
use crate::file::Edition;
use std::path::PathBuf;

/// What [`write_referee`] writes.
pub const REFEREE_FILES: [&str; 2] = ["referee.json", "referee.svg"];

/// Writes every number and the chart, and returns the paths.
///
/// # Errors
/// A file cannot be written; the folder is as it was.
pub fn write_referee(record: &RefereeRecord, edition: Edition) -> Result<Vec<PathBuf>> {
    let [numbers, chart] = REFEREE_FILES;
    let text = serde_json::to_string_pretty(record).expect("keys are text") + "\n";
    write_files(edition, &[(numbers, text), (chart, referee_svg(record))])
}
