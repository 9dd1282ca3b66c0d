//! The results of the body and of its networks under a load.

use super::gauge::{GaugeResult, Reading};
use crate::analysis::metrics::DisplacementError;
use crate::mesh::Mesh;
use crate::model::{Deformation, Support};
use crate::number::or_nan;
use crate::solve::{Ending, Solved};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A load of a scene, and the response of the finite elements.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct BodyLoad {
    /// The name of the load.
    pub name: String,
    /// The support under the load, with the displacements that it prescribes.
    pub support: Support,
    /// The nodal forces, `[points · dimension]`, N.
    pub forces: Vec<f64>,
    /// The forces include the weight under this acceleration, m/s²; `None` if the load has no gravity.
    pub gravity: Option<Vec<f64>>,
    /// Whether the load is gravity and nothing else.
    pub is_gravity: bool,
    /// The displacements of the finite elements, `[points · dimension]`, m, under the part of the load that was reached.
    pub fem: Vec<f64>,
    /// At large deformation, how the load was applied to the finite elements.
    pub followed: Option<Followed>,
    /// The gauge's reading of the finite elements; `None` without a gauge.
    pub gauge: Option<GaugeResult>,
    /// The measured displacements, if there are any; errors under this load are then relative to the measurement.
    pub measured: Option<Measured>,
    /// The deformation of the finite elements, at small deformation: beyond a bound the linear theory is not valid.
    pub deformation: Option<Deformation>,
    /// Whether the body bends or is twisted under the load.
    pub bends: bool,
    /// The finite elements lack about this share of the body's energy, because their cells are linear; `None` where the body does not bend, or the
    /// share is not known.
    pub lacking: Option<f64>,
}

/// Displacements that the errors under a load are relative to, in place of those of the finite elements of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Measured {
    /// The number of points at which at least one component is known; 0 if nothing is known of the answer of the body.
    pub points: usize,
    /// Where they are from.
    pub standard: Standard,
    /// The largest of them, m; `None` if nothing is known.
    pub largest: Option<f64>,
    /// The error of the finite elements; `None` if no measured point moves.
    pub error: Option<DisplacementError>,
    /// By how many percent the compliance of the finite elements exceeds theirs, as for a network; `None` of a measurement.
    pub work_error: Option<f64>,
    /// Their own error, estimated by the difference of two levels; `None` if it is not known.
    pub uncertainty: Option<DisplacementError>,
}

/// What gives the displacements that errors are relative to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Standard {
    /// A file of measured displacements.
    #[default]
    Measurement,
    /// The finite elements of a finer mesh.
    FinerBody,
    /// Finite elements with quadratic functions on the cells of the mesh.
    Quadratic,
    /// Finite elements with quadratic functions on the halved cells of the mesh.
    QuadraticHalved,
}

impl Standard {
    /// What heads the columns of errors, after the name of the load.
    pub fn heading(self) -> &'static str {
        match self {
            Standard::Measurement => ", measured",
            Standard::FinerBody => ", finer body",
            Standard::Quadratic | Standard::QuadraticHalved => ", quadratic",
        }
    }

    /// In words, as in "relative to the displacements …".
    pub fn words(self) -> &'static str {
        match self {
            Standard::Measurement => "measured",
            Standard::FinerBody => "of the finer body",
            Standard::Quadratic => "of quadratic elements on these cells",
            Standard::QuadraticHalved => "of quadratic elements on these cells, halved",
        }
    }
}

/// A load, and the response of a network.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LoadOutcome {
    /// The name of the load.
    pub name: String,
    /// The displacements of the network, `[points · dimension]`, m; `None` if it is not stable.
    pub displacement: Option<Vec<f64>>,
    /// The error relative to the finite elements or the measurement; `None` if the network is not stable or nothing
    /// moves.
    pub error: Option<DisplacementError>,
    /// By how many percent the compliance under the load exceeds that of the finite elements, from the work `w = f·u` of the
    /// forces: `100 (w/w_FEM − 1)`, or `100 (w_FEM/w − 1)` with the forces that hold prescribed displacements. Positive means that
    /// the network is too soft. `None` also if displacements were measured.
    pub work_error: Option<f64>,
    /// The time to assemble, factorise and solve the finite elements, as if this were the only load, s.
    pub seconds_fem: f64,
    /// The time to assemble, factorise and solve the network, as if this were the only load, s.
    pub seconds_lem: f64,
    /// How the equations were solved; at large deformation they are many.
    pub solved_fem: Option<Solved>,
    /// How the equations of the network were solved; at large deformation they are many.
    pub solved_lem: Option<Solved>,
    /// Why there are no displacements of a network that is not stable, if they were sought.
    pub unsolved: Option<String>,
    /// At large deformation, how the load was applied to the network.
    pub followed: Option<Followed>,
    /// The gauge's reading of the network.
    pub gauge: Option<Reading>,
}

/// How far a load was followed at large deformation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct Followed {
    /// The whole load was reached.
    #[serde(rename = "converged")]
    #[schemars(with = "bool")]
    pub ending: Ending,
    /// This share of the load was reached.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub load: f64,
    /// The residual is relative to the forces that act.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub residual: f64,
    /// All steps took this number of Newton's iterations.
    pub iterations: usize,
    /// This number of iterations had a tangent that was not positive definite and was shifted.
    pub shifted: usize,
    /// The forces balance to their rounding only, which is more than the tolerance.
    #[serde(rename = "rounded")]
    pub is_rounded: bool,
    /// This number of elements is turned inside out at the end, at a quadrature point or more.
    #[serde(rename = "inverted_elements")]
    pub inverted: usize,
    /// The cavity that is filled has this pressure in Pa; the key is absent under other loads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
    /// The pressure had this largest value on the way, in Pa, where the cavity was filled beyond it; else the key is absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure_passed: Option<f64>,
}

impl BodyLoad {
    /// The largest displacement of a node of the finite elements, m.
    pub fn largest_displacement(&self, mesh: &Mesh) -> f64 {
        mesh.largest_motion(&self.fem)
    }

    /// Whether the finite elements are in equilibrium under the whole load; `fem` is otherwise that of a part of it.
    pub fn is_reached(&self) -> bool {
        self.followed.is_none_or(|followed| followed.ending == Ending::Converged)
    }

    /// The gauge's reading of the finite elements, if there is one under this load.
    pub fn reading(&self) -> Option<Reading> {
        self.gauge.and_then(GaugeResult::reading)
    }
}
