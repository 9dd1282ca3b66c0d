//! What a scene writes and computes besides its table.

use schemars::JsonSchema;
use serde::Deserialize;

/// What a scene writes and computes besides its table.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Springs and displacements are written as VTU files, and a motion as a series of them.
    pub vtu: bool,
    /// Springs and points are written as CSV files.
    pub csv: bool,
    /// Each network is written whole as a JSON file.
    #[schemars(extend("default" = true))]
    pub json: Option<bool>,
    /// The errors of the elements' matrices are computed. Without them the tables have `-`, and files null.
    #[schemars(extend("default" = true))]
    pub errors: Option<bool>,
    /// What each fit, each network and the finite elements cost is measured: processor time of one thread, repeated in turns.
    pub time: bool,
    /// Young's modulus, Poisson's ratio and Zener's ratio of each whole network are measured.
    pub moduli: bool,
    /// This number of natural frequencies of each model is computed, without those of rigid motions; they need a density.
    pub frequencies: usize,
    /// The file report.json and the page report.html are written (`true`), or neither (`false`).
    #[schemars(extend("x-default" = "report.json alone"))]
    pub report: Option<bool>,
}

impl Output {
    /// Whether the report is written as a page.
    pub fn has_page(&self) -> bool {
        self.report == Some(true)
    }

    /// Whether the errors of the elements' matrices are computed.
    pub fn has_errors(&self) -> bool {
        self.errors != Some(false)
    }

    /// Whether the states of a motion are kept for pictures.
    pub fn has_pictures(&self) -> bool {
        self.vtu || self.has_page()
    }
}
