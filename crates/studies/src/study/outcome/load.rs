//! The answers of the body and of its networks to a load.

use super::gauge::{GaugeResult, Reading};
use crate::model::Deformation;
use crate::solve::{Ending, Solved};
use crate::study::metrics::DisplacementError;

/// A load of a scene and the answer of the finite elements to it.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyLoad {
    pub name: String,
    /// Displacements of the finite elements, `[points · dimension]`, m.
    pub fem: Vec<f64>,
    /// At large deformation, how far the finite elements followed the load.
    pub followed: Option<Followed>,
    /// The gauge's reading of the finite elements; `None` without a gauge.
    pub gauge: Option<GaugeResult>,
    /// `None` where nothing was measured; otherwise errors under this load are those from the measurement.
    pub measured: Option<Measured>,
    /// How far the finite elements are deformed, at small deformation: beyond a bound the linear theory does not hold.
    pub deformation: Option<Deformation>,
}

/// Displacements that were measured under a load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The number of points where at least one component is known.
    pub points: usize,
    /// Of the finite elements; `None` if no measured point moves.
    pub error: Option<DisplacementError>,
}

/// A load and the answer of a network to it.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadOutcome {
    pub name: String,
    /// Displacements of the network, `[points · dimension]`, m; `None` where it does not stand.
    pub displacement: Option<Vec<f64>>,
    /// `None` where the network does not stand or nothing moves.
    pub error: Option<DisplacementError>,
    /// By how many percent the work of the load, which is its compliance, is larger than in the finite elements: `f·u`, or that of the
    /// forces which hold given displacements. `None` also where displacements were measured.
    pub work_error: Option<f64>,
    /// To assemble, factorise and solve, each as if this were the only load.
    pub seconds_fem: f64,
    pub seconds_lem: f64,
    /// How the equations were solved; at large deformation they are many.
    pub solved_fem: Option<Solved>,
    pub solved_lem: Option<Solved>,
    /// At large deformation, how far the network followed the load.
    pub followed: Option<Followed>,
    /// The gauge's reading of the network.
    pub gauge: Option<Reading>,
}

/// How far an equilibrium was followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Followed {
    pub ending: Ending,
    /// The share of the load reached.
    pub load: f64,
    /// The last residual, relative to the forces that act.
    pub residual: f64,
    pub iterations: usize,
    /// Iterations whose tangent was not positive definite and had to be shifted.
    pub shifted: usize,
    /// Whether the forces balance to their rounding only, which is more than the tolerance.
    pub is_rounded: bool,
    /// Cells that are turned inside out at a quadrature point.
    pub inverted: usize,
}

impl BodyLoad {
    /// The gauge's reading of the finite elements, if there is one under this load.
    pub fn reading(&self) -> Option<Reading> {
        self.gauge.and_then(GaugeResult::reading)
    }
}
