//! Loads and their answers in `report.json`.

use crate::number::finite;
use crate::solve::{Ending, Solved};
use crate::study::{BodyLoad, Followed, LoadOutcome, Reading};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Young's modulus, Pa, and Poisson's ratio as a gauge measures them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReadingRecord {
    /// Young's modulus is in Pa, as the tension test measures it.
    pub young: f64,
    /// Poisson's ratio is that which the tension test measures.
    pub poisson: f64,
}

/// A load under which displacements were measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuredRecord {
    /// The load has this name.
    pub load: String,
    /// This number of points has a measured displacement.
    pub points: usize,
    /// The finite elements have this root mean square distance from the measured displacements, percent of the largest.
    pub fem_e_rms: Option<f64>,
    /// The finite elements have this largest distance from the measured displacements, percent of the largest.
    pub fem_e_max: Option<f64>,
}

/// How far an equilibrium was followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FollowedRecord {
    /// The whole load was reached.
    pub converged: bool,
    /// This share of the load was reached.
    pub load: Option<f64>,
    /// The residual is relative to the forces that act.
    pub residual: Option<f64>,
    /// All steps took this number of Newton's iterations.
    pub iterations: usize,
    /// This number of iterations had a tangent that was shifted.
    pub shifted: usize,
    /// The forces balance to their rounding only, which is more than the tolerance.
    pub rounded: bool,
    /// This number of elements is turned inside out at the end.
    pub inverted_elements: usize,
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
    /// The network is softer than the finite elements by this error of the compliance, percent. With the work w of the load it is `w/w_FEM
    /// − 1`; where displacements are prescribed, with the work of the forces that hold them, `w_FEM/w − 1`.
    pub e_energy: Option<f64>,
    /// The finite elements took this time in s to assemble, factorise and solve, as if this were the only load.
    pub seconds_fem: f64,
    /// The network took this time in s to assemble, factorise and solve, as if this were the only load.
    pub seconds_lem: f64,
    /// `solver_fem` says how the equations of the finite elements were solved; it is null at large deformation.
    pub solver_fem: Option<SolvedRecord>,
    /// `solver_lem` says how the equations of the network were solved; it is null at large deformation or without an answer.
    pub solver_lem: Option<SolvedRecord>,
    /// `followed` says how far the network followed the load at large deformation; it is null at small deformation.
    pub followed: Option<FollowedRecord>,
    /// `gauge` has what the tension test of the network gives; it is null without `[gauge]`.
    pub gauge: Option<ReadingRecord>,
}

/// How linear equations were solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SolvedRecord {
    /// The equations were solved by `cholesky`, `lu` or `multigrid`.
    pub method: String,
    /// This number of displacements is not held.
    pub unknowns: usize,
    /// Conjugate gradients took this number of iterations; it is null with a factor.
    pub iterations: Option<usize>,
    /// The share `‖f − K u‖/‖f‖` of the forces is left.
    pub residual: Option<f64>,
    /// The text has nodes and unknowns of each on all levels of the multigrid, the finest first; it is null with a factor.
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
