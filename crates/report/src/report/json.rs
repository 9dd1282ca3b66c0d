//! `report.json`: stable keys, numbers in SI units, errors of displacements in percent.

use super::agreement::{Agreement, agreements};
use super::fit_record::FitRecord;
use super::linear_theory::DeformationRecord;
use super::motion_record::{MotionOptionsRecord, MotionRecord};
use super::notes::notes;
use super::verdict::finite_elements_verdict;
use crate::material::RegionMaterial;
use crate::mesh::Quality;
use crate::study::{
    BodyLoad, DynamicModuliOutcome, Followed, FrequencyOutcome, GaugeResult, Measured, MeasuredDamping, ModelTimes,
    Outcome, Reading,
};
use schemars::{JsonSchema, schema_for};
use serde::{Deserialize, Serialize};

/// The version of the report's keys changes when a key is removed or its meaning changes. Version 3 has no `residual` of whole-object fits.
pub const VERSION: u32 = 3;

/// Reports from this version on have all keys that this program reads.
pub(super) const OLDEST: u32 = 2;

/// `report.json`. A value that does not exist or is not finite is null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// The version of the format changes when a key is removed or its meaning changes.
    #[schemars(extend("const" = VERSION))]
    pub version: u32,
    /// The scene has this title.
    pub scene: String,
    /// These values stand in place of those of the scene's file, as `KEY=VALUE`; `--set` gives them.
    pub settings: Vec<String>,
    /// The box around the body has this size along each axis, m.
    pub extent: Vec<f64>,
    /// A sentence says what was assumed because no input says it.
    pub assumed: Option<String>,
    /// The mesh has this number of points.
    pub nodes: usize,
    /// The mesh has this number of cells.
    pub elements: usize,
    /// The cells have elements of these names.
    pub element_types: Vec<String>,
    /// What must be known first of the finite elements of the mesh: `not trusted`, `locks` or `too stiff`; it is empty if they are right.
    #[serde(default)]
    pub finite_elements_verdict: String,
    /// This number of elements had their nodes numbered the other way round.
    pub turned_elements: usize,
    /// This number of points of the file belongs to no element.
    pub unused_nodes: usize,
    /// `quality` has what is known of the shapes of the cells.
    pub quality: Quality,
    /// The largest network has this number of springs.
    pub springs: Option<usize>,
    /// Young's modulus of the material is in Pa; it is null if it differs from cell to cell.
    pub young: Option<f64>,
    /// Poisson's ratio of the material is null if it differs from cell to cell.
    pub poisson: Option<f64>,
    /// Each region has a material; a body without regions has one entry.
    pub materials: Vec<RegionMaterial>,
    /// The material's law has this title.
    pub law: Option<String>,
    /// Each entry says how far the finite elements followed a load; the list is empty at small deformation.
    pub loads_followed: Vec<Followed>,
    /// Each entry says how far linear finite elements are deformed under a load.
    pub deformations: Vec<DeformationRecord>,
    /// The scene did not ask for these stages; each entry has the reason.
    pub left_out: Vec<String>,
    /// Each entry is a load whose errors are not relative to the finite elements of the mesh, but to a measurement or to a finer solution.
    pub measured: Vec<Measured>,
    /// Each entry has what the tension test of the finite elements gives under a load; the list is empty without `[gauge]`.
    pub gauge: Vec<Option<Reading>>,
    /// Each entry says whether whole-object fits that differ in their start alone agree.
    pub starts: Vec<Agreement>,
    /// Each entry has the lowest natural frequencies of a model.
    pub frequencies: Vec<FrequencyOutcome>,
    /// Each entry is damping that was measured, with what was fitted to it and the error that it leaves; the key is left out where none was.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub damping: Vec<MeasuredDamping>,
    /// `dynamic_moduli` has storage and loss moduli over frequency; the key is left out without `dynamic_moduli` in `[output]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dynamic_moduli: Option<DynamicModuliOutcome>,
    /// `model_times` has what the finite elements of the mesh cost on one thread, repeated; it is null without `time = true` in `[output]`.
    #[serde(default)]
    pub model_times: Option<ModelTimes>,
    /// `motion_options` says how motions were computed; it is null without `[motion]`.
    pub motion_options: Option<MotionOptionsRecord>,
    /// Each entry is the motion of a model.
    pub motion: Vec<MotionRecord>,
    /// Each entry is a fit, in the order of the scene.
    pub fits: Vec<FitRecord>,
    /// Each sentence says what a reader must know before trusting a figure. Those of a filled surface have its volumes and faults as well.
    pub notes: Vec<String>,
    /// The run has written these files into its folder, with the report itself; `plot` draws no others. Files that the `.pvd` of a motion
    /// lists are not named.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
}

/// The JSON Schema of reports.
pub fn schema() -> serde_json::Value {
    schema_for!(Report).to_value()
}

/// The report as text.
pub fn report(outcome: &Outcome) -> String {
    Report::of(outcome).text()
}

impl Report {
    /// The text of `report.json`.
    pub(super) fn text(&self) -> String {
        serde_json::to_string_pretty(self).expect("keys are text") + "\n"
    }

    /// The report of a run, without the files that it writes.
    pub fn of(outcome: &Outcome) -> Report {
        let mesh = &outcome.mesh;
        let materials = outcome.material.by_region(mesh.cell_count());
        let same = |of: fn(&RegionMaterial) -> [Option<f64>; 2]| {
            let first = materials.first().and_then(|region| of(region)[0]);
            first.filter(|_| materials.iter().all(|region| of(region) == [first; 2]))
        };
        let gauge = |load: &BodyLoad| load.gauge.map(GaugeResult::reading);
        let models = outcome.motion.iter().flat_map(|motion| &motion.models);
        let fit = |fit| FitRecord::of(outcome, fit);
        Report {
            version: VERSION,
            scene: outcome.scene.clone(),
            settings: outcome.settings.clone(),
            extent: mesh.extent(),
            assumed: outcome.assumed.clone(),
            nodes: mesh.node_count(),
            elements: mesh.cell_count(),
            element_types: mesh.blocks.iter().map(|block| block.element.name.clone()).collect(),
            finite_elements_verdict: finite_elements_verdict(outcome),
            turned_elements: mesh.reversed,
            unused_nodes: mesh.unused_points,
            quality: mesh.quality.clone(),
            springs: outcome.fits.iter().map(|fit| fit.network.len()).max(),
            young: same(|region| region.young),
            poisson: same(|region| region.poisson),
            materials,
            law: outcome.law.clone(),
            loads_followed: outcome.loads.iter().filter_map(|load| load.followed).collect(),
            deformations: DeformationRecord::all(outcome),
            left_out: outcome.left_out.clone(),
            measured: outcome.loads.iter().filter_map(|load| load.measured.clone()).collect(),
            gauge: outcome.loads.iter().filter_map(gauge).collect(),
            starts: agreements(outcome),
            frequencies: outcome.frequencies.clone(),
            damping: outcome.damping.clone(),
            dynamic_moduli: outcome.dynamic_moduli.clone(),
            model_times: outcome.model_times.clone(),
            motion_options: outcome.motion.as_ref().map(MotionOptionsRecord::from),
            motion: models.map(MotionRecord::from).collect(),
            fits: outcome.fits.iter().map(fit).collect(),
            notes: notes(outcome),
            files: Vec::new(),
        }
    }
}
