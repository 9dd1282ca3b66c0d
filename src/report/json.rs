//! `report.json`: stable keys, numbers in SI units, errors of displacements in percent.

use super::agreement::{Agreement, SAME, agreements};
use super::fit_record::FitRecord;
use super::frequencies::FrequencyRecord;
use super::linear_theory::DeformationRecord;
use super::load_record::{FollowedRecord, MeasuredRecord, ReadingRecord};
use super::motion_record::{MotionOptionsRecord, MotionRecord};
use super::number::finite;
use super::region_record::RegionRecord;
use super::table::notes;
use crate::mesh::Mesh;
use crate::study::{BodyLoad, GaugeResult, Outcome, extent};
use schemars::{JsonSchema, schema_for};
use serde::{Deserialize, Serialize};

/// Of the report's keys; it changes when a key is removed or its meaning changes.
pub const VERSION: u32 = 2;

/// `report.json`. A value that does not exist or is not finite is null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// [`VERSION`].
    pub version: u32,
    /// The title.
    pub scene: String,
    /// What was given in place of values of the scene's file, as `KEY=VALUE`.
    pub settings: Vec<String>,
    /// The size of the box around the body along each axis, m.
    pub extent: Vec<f64>,
    /// What was assumed because no input says it, as a sentence.
    pub assumed: Option<String>,
    /// The number of points of the mesh.
    pub nodes: usize,
    /// The number of cells.
    pub elements: usize,
    /// The names of the elements of the mesh.
    pub element_types: Vec<String>,
    /// Elements whose nodes were numbered the other way round.
    pub turned_elements: usize,
    /// Points of the file that no cell uses.
    pub unused_nodes: usize,
    /// What is known of the shapes of the cells.
    pub quality: QualityRecord,
    /// Of the largest network.
    pub springs: Option<usize>,
    /// Pa; null if it differs from cell to cell.
    pub young: Option<f64>,
    /// Poisson's ratio; null if it differs from cell to cell.
    pub poisson: Option<f64>,
    /// The material of each region; one without a name if the body has no regions.
    pub materials: Vec<RegionRecord>,
    /// The title of the material's law.
    pub law: Option<String>,
    /// How far the finite elements followed each load; empty at small deformation.
    pub loads_followed: Vec<FollowedRecord>,
    /// How far linear finite elements are deformed.
    pub deformations: Vec<DeformationRecord>,
    /// Stages that the scene did not ask for, with the reason.
    pub left_out: Vec<String>,
    /// Loads under which displacements were measured.
    pub measured: Vec<MeasuredRecord>,
    /// Of the finite elements under each load; empty without a gauge.
    pub gauge: Vec<Option<ReadingRecord>>,
    /// Whole-object fits that differ in their start alone.
    pub starts: Vec<AgreementRecord>,
    /// The lowest natural frequencies.
    pub frequencies: Vec<FrequencyRecord>,
    /// How motions were computed; null without `[motion]`.
    pub motion_options: Option<MotionOptionsRecord>,
    /// Of each model that moved.
    pub motion: Vec<MotionRecord>,
    /// The fits in the order of the scene.
    pub fits: Vec<FitRecord>,
    /// What a reader must know before trusting a figure, one sentence each.
    pub notes: Vec<String>,
    /// In `report.json`, the names of the files that the run has written into its folder, with that of the report; those that a motion's
    /// `.pvd` lists are not named.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
}

/// The quality of the mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct QualityRecord {
    /// From 0, flat, to 1, right angles.
    pub worst: Option<f64>,
    /// The element and number of the cell with the least quality.
    pub worst_cell: Option<String>,
    /// Null if the quality was not measured, as that of a mesh that is generated.
    pub poor_elements: Option<usize>,
    /// Left out: of poor quality, flat or tangled.
    pub skipped_elements: usize,
    /// Left out: elements with the nodes of another.
    pub duplicate_elements: usize,
    /// Left out: elements folded over their neighbours.
    pub folded_elements: usize,
    /// Null if coordinates are too coarse to tell.
    pub coincident_nodes: Option<usize>,
    /// On edges and faces that do not have them; null if coordinates are too coarse to tell, or if the mesh was generated or divided.
    pub hanging_nodes: Option<usize>,
    /// Parts that share no node; null if they were not counted.
    pub pieces: Option<usize>,
}

/// Whether whole-object fits from several starts give the same errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AgreementRecord {
    /// The names of the fits that start differently.
    pub fits: Vec<String>,
    /// The held-out load under which the errors differ most.
    pub load: String,
    /// As a share of the least error.
    pub difference: Option<f64>,
    /// Whether the errors differ by no more than a fifth.
    pub agree: bool,
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
        let Outcome { mesh, material, .. } = outcome;
        let thickness = material.thicknesses().uniform().copied();
        let materials = RegionRecord::all(outcome);
        let same = |of: fn(&RegionRecord) -> [Option<f64>; 2]| {
            let first = materials.first().and_then(|region| of(region)[0]);
            first.filter(|_| materials.iter().all(|region| of(region) == [first; 2]))
        };
        let gauge = |load: &BodyLoad| load.gauge.map(GaugeResult::reading);
        let models = outcome.motion.iter().flat_map(|motion| &motion.models);
        let fit = |fit| FitRecord::of(fit, mesh.cell_count(), thickness);
        Report {
            version: VERSION,
            scene: outcome.scene.clone(),
            settings: outcome.settings.clone(),
            extent: extent(mesh),
            assumed: outcome.assumed.clone(),
            nodes: mesh.point_count(),
            elements: mesh.cell_count(),
            element_types: mesh.blocks.iter().map(|block| block.element.name.clone()).collect(),
            turned_elements: mesh.reversed,
            unused_nodes: mesh.unused_points,
            quality: QualityRecord::of(mesh),
            springs: outcome.fits.iter().map(|fit| fit.network.len()).max(),
            young: same(|region| region.young),
            poisson: same(|region| region.poisson),
            materials,
            law: outcome.law.clone(),
            loads_followed: outcome.loads.iter().filter_map(|load| Some(load.followed.as_ref()?.into())).collect(),
            deformations: DeformationRecord::all(outcome),
            left_out: outcome.left_out.clone(),
            measured: outcome.loads.iter().filter_map(MeasuredRecord::of).collect(),
            gauge: outcome.loads.iter().filter_map(gauge).map(|reading| reading.map(ReadingRecord::from)).collect(),
            starts: agreements(outcome).iter().map(AgreementRecord::from).collect(),
            frequencies: outcome.frequencies.iter().map(FrequencyRecord::from).collect(),
            motion_options: outcome.motion.as_ref().map(MotionOptionsRecord::from),
            motion: models.map(MotionRecord::from).collect(),
            fits: outcome.fits.iter().map(fit).collect(),
            notes: notes(outcome),
            files: Vec::new(),
        }
    }
}

impl QualityRecord {
    fn of(mesh: &Mesh) -> QualityRecord {
        let quality = &mesh.quality;
        QualityRecord {
            worst: quality.worst.as_ref().and_then(|worst| finite(worst.quality)),
            worst_cell: quality.worst.as_ref().map(|worst| worst.cell.to_string()),
            poor_elements: quality.worst.as_ref().map(|_| quality.poor),
            skipped_elements: quality.skipped,
            duplicate_elements: quality.duplicates,
            folded_elements: quality.folded,
            coincident_nodes: quality.coincident,
            hanging_nodes: quality.hanging,
            pieces: quality.pieces,
        }
    }
}

impl From<&Agreement> for AgreementRecord {
    fn from(agreement: &Agreement) -> AgreementRecord {
        AgreementRecord {
            fits: agreement.fits.clone(),
            load: agreement.load.clone(),
            difference: finite(agreement.difference),
            agree: agreement.difference <= SAME,
        }
    }
}
