//! Loads and their answers in `report.json`.

use super::number::finite;
use crate::solve::{Ending, Solved};
use crate::study::{BodyLoad, Followed, LoadOutcome, Reading};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Young's modulus, Pa, and Poisson's ratio as a gauge measures them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReadingRecord {
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

/// A load under which displacements were measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuredRecord {
    /// The name of the load.
    pub load: String,
    /// The number of points with a measured displacement.
    pub points: usize,
    /// Of the finite elements, percent.
    pub fem_e_rms: Option<f64>,
    /// As `fem_e_rms`, the largest error.
    pub fem_e_max: Option<f64>,
}

/// How far an equilibrium was followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FollowedRecord {
    /// Whether the whole load was reached.
    pub converged: bool,
    /// The share of the load that was reached.
    pub load: Option<f64>,
    /// Relative to the forces that act.
    pub residual: Option<f64>,
    /// Newton's iterations of all steps.
    pub iterations: usize,
    /// Iterations whose tangent was shifted.
    pub shifted: usize,
    /// Whether the forces balance to their rounding only, which is more than the tolerance.
    pub rounded: bool,
    /// Elements that are inverted at the end.
    pub inverted_elements: usize,
}

/// The answer of a network to a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LoadRecord {
    /// The name of the load.
    pub name: String,
    /// Percent of the largest displacement.
    pub e_rms: Option<f64>,
    /// The largest error, percent of the largest displacement.
    pub e_max: Option<f64>,
    /// Percent of the largest displacement, at the point that moves most in the finite elements.
    pub e_tip: Option<f64>,
    /// By how many percent the network is softer than the finite elements: from the work of the load, twice the energy of a linear
    /// model, or from the inverse of that under prescribed displacements.
    pub e_energy: Option<f64>,
    /// To assemble, factorise and solve, each as if this were the only load.
    pub seconds_fem: f64,
    /// As `seconds_fem`, with the network.
    pub seconds_lem: f64,
    /// Null at large deformation.
    pub solver_fem: Option<SolvedRecord>,
    /// Null where the network has no answer.
    pub solver_lem: Option<SolvedRecord>,
    /// How the load was followed at large deformation.
    pub followed: Option<FollowedRecord>,
    /// The reading of the gauge; null without `[gauge]`.
    pub gauge: Option<ReadingRecord>,
}

/// How linear equations were solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SolvedRecord {
    /// `cholesky` or `lu`; `multigrid`.
    pub method: String,
    /// Displacements that are not held.
    pub unknowns: usize,
    /// Null with a factor.
    pub iterations: Option<usize>,
    /// `‖f − K u‖/‖f‖`.
    pub residual: Option<f64>,
    /// Nodes and unknowns of each on all levels, the finest first.
    pub levels: Option<String>,
}

impl From<&Solved> for SolvedRecord {
    fn from(solved: &Solved) -> SolvedRecord {
        SolvedRecord {
            method: solved.method.into(),
            unknowns: solved.unknowns,
            iterations: solved.iterations,
            residual: finite(solved.residual),
            levels: solved.levels.clone(),
        }
    }
}

impl From<Reading> for ReadingRecord {
    fn from(reading: Reading) -> ReadingRecord {
        ReadingRecord { young: reading.young, poisson: reading.poisson }
    }
}

impl MeasuredRecord {
    /// `None` if nothing was measured under the load.
    pub(super) fn of(load: &BodyLoad) -> Option<MeasuredRecord> {
        let measured = load.measured?;
        Some(MeasuredRecord {
            load: load.name.clone(),
            points: measured.points,
            fem_e_rms: measured.error.and_then(|e| finite(e.rms)),
            fem_e_max: measured.error.and_then(|e| finite(e.max)),
        })
    }
}

impl From<&Followed> for FollowedRecord {
    fn from(followed: &Followed) -> FollowedRecord {
        FollowedRecord {
            converged: followed.ending == Ending::Converged,
            load: finite(followed.load),
            residual: finite(followed.residual),
            iterations: followed.iterations,
            shifted: followed.shifted,
            rounded: followed.is_rounded,
            inverted_elements: followed.inverted,
        }
    }
}

impl From<&LoadOutcome> for LoadRecord {
    fn from(load: &LoadOutcome) -> LoadRecord {
        LoadRecord {
            name: load.name.clone(),
            e_rms: load.error.and_then(|e| finite(e.rms)),
            e_max: load.error.and_then(|e| finite(e.max)),
            e_tip: load.error.and_then(|e| finite(e.tip)),
            e_energy: load.work_error.and_then(finite),
            seconds_fem: load.seconds_fem,
            seconds_lem: load.seconds_lem,
            solver_fem: load.solved_fem.as_ref().map(SolvedRecord::from),
            solver_lem: load.solved_lem.as_ref().map(SolvedRecord::from),
            followed: load.followed.as_ref().map(FollowedRecord::from),
            gauge: load.gauge.map(ReadingRecord::from),
        }
    }
}
