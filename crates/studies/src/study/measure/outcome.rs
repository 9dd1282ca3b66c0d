//! What is measured of a network.

use crate::analysis::homogenise::{Elasticity, Tension};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use springfit_scenes::EngineLimit;

/// A network as a material and as a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct MeasuredNetwork {
    /// A point has this number of coordinates.
    pub dimension: usize,
    /// The network has this number of points.
    pub points: usize,
    /// The network has this number of springs; in a network that repeats itself those of one period.
    pub springs: usize,
    /// This number of springs has a constant below zero.
    pub negative_springs: usize,
    /// The volume is in m³; a plane network without a thickness is 1 m thick.
    pub volume: f64,
    /// The volume is that of the `cells`, of the `period`, of the convex `hull`, of the `points`, or `given`.
    pub volume_of: String,
    /// The mass is in kg; it is null without masses.
    pub mass: Option<f64>,
    /// The density is in kg/m³; it is null without masses.
    pub density: Option<f64>,
    /// `tension` says how springs pull on each other in the shape in which the network is given; it is null where a spring of no length has
    /// no direction.
    pub tension: Option<Tension>,
    /// `affine` is the material whose every point follows the strain: the energy of uniform strains over the volume, which bounds the stiffness
    /// from above.
    pub affine: Elasticity,
    /// `relaxed` is the material where points give way to each other: all of a period, or those inside a body whose boundary follows the
    /// strain. It is null where it is not known which points are the boundary.
    pub relaxed: Option<Elasticity>,
    /// Each entry is the material of some points.
    pub regions: Vec<MeasuredRegion>,
    /// `stability` counts motions without resistance.
    pub stability: NetworkStability,
    /// The lowest natural frequencies that deform the network are in Hz, as it is held; the list is null without masses, of a network that
    /// repeats itself, and where some motion releases energy.
    pub frequencies: Option<Vec<f64>>,
    /// Symplectic Euler without damping is stable below this step in s; it is null without masses.
    pub longest_step: Option<f64>,
    /// `engine` says how stiff a body an engine can hold at its settings; it is null where no engine is asked for, or it has no limit.
    pub engine: Option<EngineLimit>,
    /// Each sentence says what a reader must know.
    pub notes: Vec<String>,
}

/// The material of some points of a network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuredRegion {
    /// The region has this name.
    pub name: String,
    /// The region has this number of points.
    pub points: usize,
    /// The volume of the points is in m³: each has its share of the cells around it.
    pub volume: f64,
    /// `affine` is the material whose every point follows the strain. A spring belongs to its points in equal shares, so that a region has half of
    /// the springs that cross its border.
    pub affine: Elasticity,
}

/// Motions of a network that meet no resistance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct NetworkStability {
    /// This number of motions releases energy.
    pub releasing: usize,
    /// This number of motions meets no resistance, without rigid ones.
    pub mechanisms: usize,
    /// The network as it is held has this number of rigid motions; of a network that repeats itself they are translations.
    pub rigid: usize,
    /// Whether all motions are counted; of a large network there may be more.
    pub is_complete: bool,
}

impl NetworkStability {
    /// Whether every motion that is not rigid meets resistance.
    pub fn is_stable(&self) -> bool {
        self.releasing == 0 && self.mechanisms == 0
    }
}
