//! What a scene has written and worked out beside its table.

use schemars::JsonSchema;
use serde::Deserialize;

#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// The springs and displacements as VTU files, a motion as a series of them.
    pub vtu: bool,
    /// The springs as a CSV file.
    pub csv: bool,
    /// What each network is as a material: Young's modulus, Poisson's ratio, Zener's ratio.
    pub moduli: bool,
    /// How many natural frequencies of each model, beyond those of rigid motions.
    pub frequencies: usize,
    /// report.json; written unless switched off.
    pub report: Option<bool>,
}
