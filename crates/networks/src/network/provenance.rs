//! Where a network comes from: the keys `provenance` and `plane` of its JSON file.

use crate::material::Plane;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Where a network comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProvenanceRecord {
    /// The program has this name and version.
    pub program: String,
    /// The program was given this command; it is null if a library made the network.
    pub command: Option<String>,
    /// The scene has this title; of a mesh alone it is the file.
    pub scene: Option<String>,
    /// These values of `--set` stand in place of those of the scene.
    pub settings: Vec<String>,
    /// Words say where the mesh comes from.
    pub mesh: Option<String>,
    /// CRC-32 of the points as little-endian numbers of 64 bits, followed by the cells as integers of 32 bits, is written as eight
    /// hexadecimal digits.
    pub mesh_checksum: String,
    /// The material was fitted; it is null if it differs from cell to cell.
    pub material: Option<MaterialDataRecord>,
    /// `fit` has the fit with its errors.
    pub fit: Option<FitSummaryRecord>,
}

/// The material of a network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialDataRecord {
    /// Young's modulus is in Pa.
    pub young: f64,
    /// Poisson's ratio has no unit.
    pub poisson: f64,
    /// The body is `solid`, in `plane stress` or `plane strain`, or a `rod`.
    pub state: String,
    /// The thickness is in m, and the cross-section of a rod in m²; it is 1 for a solid.
    pub thickness: f64,
    /// The density is in kg/m³; it is null without one.
    pub density: Option<f64>,
    /// The law at large deformation has this title; it is null without one.
    pub law: Option<String>,
}

/// The state of a plane body or a surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaneRecord {
    /// The body is in plane `stress` or plane `strain`.
    pub state: Plane,
    /// The thickness is in m; where it varies, it is its mean over the area.
    pub thickness: f64,
    /// The thickness differs from cell to cell.
    #[serde(default)]
    pub varies: bool,
}

/// The fit that made a network, and its errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FitSummaryRecord {
    /// The fit has this name.
    pub name: String,
    /// The objective has this name.
    pub objective: String,
    /// All settings of the objective are here, as in report.json.
    pub settings: BTreeMap<String, serde_json::Value>,
    /// The network is `fitted`, `stable`, `near-mechanism`, `indefinite` or a `mechanism`; at large deformation it is `converged` or
    /// `stalled`.
    pub status: String,
    /// This number of springs has a constant below zero.
    pub negative_springs: usize,
    /// The elements have these errors `‖R − K‖/‖R‖`, mean and largest; the pair is null where springs belong to no element.
    pub relative_frobenius: Option<[f64; 2]>,
    /// The elasticity tensor has the distance `‖C − C₀‖/‖C₀‖` from that of the material.
    pub relative_tensor: Option<f64>,
    /// Each entry has the errors under a load of the scene.
    pub loads: Vec<LoadErrorsRecord>,
}

/// The errors of a network under a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadErrorsRecord {
    /// The load has this name.
    pub name: String,
    /// The root mean square error is in percent of the largest displacement.
    pub e_rms: Option<f64>,
    /// The largest error is in percent of the largest displacement.
    pub e_max: Option<f64>,
    /// The error at the point that moves most, or the largest of equal ones, is in percent of the largest displacement.
    pub e_tip: Option<f64>,
    /// The network is softer than the finite elements by this error of the compliance, percent, from the work of the load.
    pub e_energy: Option<f64>,
}
