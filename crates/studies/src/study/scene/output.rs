//! What a scene writes and computes besides its table.

use schemars::JsonSchema;
use serde::Deserialize;

/// What a scene writes and computes besides its table.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Whether the springs and displacements are written as VTU files, a motion as a series of them.
    pub vtu: bool,
    /// Whether the springs are written as a CSV file.
    pub csv: bool,
    /// Whether the networks are written whole as JSON files; they are unless switched off.
    pub json: Option<bool>,
    /// Whether the errors of the elements' matrices are computed; they are unless switched off.
    pub errors: Option<bool>,
    /// Whether each network is measured as a material: Young's modulus, Poisson's ratio, Zener's ratio.
    pub moduli: bool,
    /// The number of natural frequencies of each model, besides those of rigid motions.
    pub frequencies: usize,
    /// Which reports are written: `true` report.json and the page report.html, `false` neither; by default report.json alone.
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
