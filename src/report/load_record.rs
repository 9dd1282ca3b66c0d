//! Loads and their answers in `report.json`.

use crate::mesh::Mesh;
use crate::number::finite;
use crate::solve::Solved;
use crate::study::{BodyLoad, Followed, LoadOutcome, Reading, Standard};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A load whose errors are not relative to the finite elements of the mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuredRecord {
    /// The load has this name.
    pub load: String,
    /// Errors are relative to displacements from there.
    #[serde(default)]
    pub standard: Standard,
    /// This number of points has a known displacement; 0 says that the errors are not known.
    pub points: usize,
    /// The largest known displacement is this, m.
    #[serde(default)]
    pub largest: Option<f64>,
    /// The finite elements have this root mean square distance from the known displacements, percent of the largest.
    pub fem_e_rms: Option<f64>,
    /// The finite elements have this largest distance from the known displacements, percent of the largest.
    pub fem_e_max: Option<f64>,
    /// The finite elements have this error at the point that moves most, percent of the largest displacement.
    #[serde(default)]
    pub fem_e_tip: Option<f64>,
    /// The finite elements have this error of the compliance, percent; it is null where displacements were measured.
    #[serde(default)]
    pub fem_e_energy: Option<f64>,
    /// The known displacements are themselves right to about this root mean square distance, percent of the largest; it is null where that
    /// is not known.
    #[serde(default)]
    pub uncertainty_rms: Option<f64>,
    /// The known displacements are themselves right to about this largest distance, percent of the largest.
    #[serde(default)]
    pub uncertainty_max: Option<f64>,
}

/// The answer of a network to a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LoadRecord {
    /// The load has this name.
    pub name: String,
    /// The root mean square error is in percent of the largest displacement.
    pub e_rms: Option<f64>,
    /// The largest error is in percent of the largest displacement.
    pub e_max: Option<f64>,
    /// The error at the point that moves most in the finite elements is in percent of the largest displacement.
    pub e_tip: Option<f64>,
    /// The network moves by at most this, m; it is null where it has no equilibrium.
    #[serde(default)]
    pub largest_displacement: Option<f64>,
    /// The network is softer than the finite elements by this error of the compliance, percent. With the work w of the load it is `w/w_FEM
    /// − 1`; where displacements are prescribed, with the work of the forces that hold them, `w_FEM/w − 1`.
    pub e_energy: Option<f64>,
    /// The finite elements took this processor time in s to assemble, factorise and solve, as if this were the only load.
    pub seconds_fem: f64,
    /// The network took this processor time in s to assemble, factorise and solve, as if this were the only load.
    pub seconds_lem: f64,
    /// `solver_fem` says how the equations of the finite elements were solved; it is null at large deformation.
    pub solver_fem: Option<Solved>,
    /// `solver_lem` says how the equations of the network were solved; it is null at large deformation or without an answer.
    pub solver_lem: Option<Solved>,
    /// `followed` says how far the network followed the load at large deformation; it is null at small deformation.
    pub followed: Option<Followed>,
    /// `gauge` has what the tension test of the network gives; it is null without `[gauge]`.
    pub gauge: Option<Reading>,
}

impl MeasuredRecord {
    /// `None` if errors under the load are relative to the finite elements.
    pub(super) fn of(load: &BodyLoad) -> Option<MeasuredRecord> {
        let measured = load.measured?;
        Some(MeasuredRecord {
            load: load.name.clone(),
            standard: measured.standard,
            points: measured.points,
            largest: measured.largest.and_then(finite),
            fem_e_rms: measured.error.and_then(|e| finite(e.rms)),
            fem_e_max: measured.error.and_then(|e| finite(e.max)),
            fem_e_tip: measured.error.and_then(|e| finite(e.tip)),
            fem_e_energy: measured.work_error.and_then(finite),
            uncertainty_rms: measured.uncertainty.and_then(|e| finite(e.rms)),
            uncertainty_max: measured.uncertainty.and_then(|e| finite(e.max)),
        })
    }
}

impl LoadRecord {
    /// Makes the record of an answer on a mesh.
    pub(super) fn of(load: &LoadOutcome, mesh: &Mesh) -> LoadRecord {
        LoadRecord {
            name: load.name.clone(),
            e_rms: load.error.and_then(|e| finite(e.rms)),
            e_max: load.error.and_then(|e| finite(e.max)),
            e_tip: load.error.and_then(|e| finite(e.tip)),
            largest_displacement: load.displacement.as_ref().and_then(|u| finite(mesh.largest_motion(u))),
            e_energy: load.work_error.and_then(finite),
            seconds_fem: load.seconds_fem,
            seconds_lem: load.seconds_lem,
            solver_fem: load.solved_fem.clone(),
            solver_lem: load.solved_lem.clone(),
            followed: load.followed,
            gauge: load.gauge,
        }
    }
}
