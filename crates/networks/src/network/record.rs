//! The record of a network: the keys of its JSON file, for writing, for reading and for the schema.

use schemars::{JsonSchema, schema_for};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// What the key `format` of a network file says.
pub const FORMAT: &str = "springfit network";
/// The version of network files. It changes when a key is removed or its meaning changes.
pub const NETWORK_VERSION: u32 = 1;

/// A network in JSON, whole. Every key is there whatever the fit; what is not known is null or empty. Points, cells, groups, measures
/// and springs are named by their places in the lists, from 0. Springs are last, because there are most of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NetworkRecord<S = Vec<SpringRecord<'static>>, C = Vec<Vec<usize>>> {
    /// `springfit network`.
    pub format: String,
    /// The version of the format.
    pub version: u32,
    /// Where the network comes from.
    pub provenance: ProvenanceRecord,
    /// The number of coordinates of a point.
    pub dimension: usize,
    /// By quantity; the constants of springs by kind.
    pub units: BTreeMap<String, String>,
    /// `[points][dimension]`, m.
    pub points: Vec<Vec<f64>>,
    /// What `nodes` are; null of a mesh that is no file.
    pub numbering: Option<String>,
    /// The numbers of the points in the mesh file, `[points]`.
    pub nodes: Option<Vec<u64>>,
    /// `[points]`, kg; null without a density.
    pub masses: Option<Vec<f64>>,
    /// The cells of the mesh, for each element.
    pub cells: Vec<CellBlockRecord<C>>,
    /// Triangles between points on the boundary of a solid, counterclockwise as seen from outside; of a plane or surface its cells.
    pub surface: Vec<[usize; 3]>,
    /// The points that are held, with `[[fix]]` of the scene.
    pub held: Vec<HeldRecord>,
    /// The loads of the scene as nodal forces.
    pub loads: Vec<NodalLoadRecord>,
    /// m/s², `[dimension]`; null where the scene says nothing of it.
    pub gravity: Option<Vec<f64>>,
    /// The damping of the motion.
    pub damping: NetworkDampingRecord,
    /// The motion of the scene.
    pub motion: Option<DriveRecord>,
    /// The longest step of an explicit method without damping, `2/ω` of the fastest motion at rest, s; null without masses.
    pub largest_step: Option<f64>,
    /// The groups of springs in the element files.
    pub groups: Vec<OriginRecord>,
    /// What springs measure.
    pub measures: Vec<MeasureRecord>,
    /// What a reader must know of the fit, one sentence each.
    pub notes: Vec<String>,
    /// The springs.
    pub springs: S,
}

/// Where a network comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProvenanceRecord {
    /// The program and its version.
    pub program: String,
    /// The command that was given; null if a library made the network.
    pub command: Option<String>,
    /// The title of the scene, or the file of the mesh.
    pub scene: Option<String>,
    /// Values given by `--set` in place of those of the scene.
    pub settings: Vec<String>,
    /// Where the mesh comes from, in words.
    pub mesh: Option<String>,
    /// CRC-32 of the points as little-endian numbers of 64 bits, followed by the cells as integers of 32 bits; eight hexadecimal digits.
    pub mesh_checksum: String,
    /// The material that was fitted; null if it differs from cell to cell.
    pub material: Option<MaterialDataRecord>,
    /// The fit with its errors.
    pub fit: Option<FitSummaryRecord>,
}

/// The material of a network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialDataRecord {
    /// Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// `solid`, `plane stress`, `plane strain` or `rod`.
    pub state: String,
    /// m; the cross-section of a rod in m²; 1 for a solid.
    pub thickness: f64,
    /// kg/m³.
    pub density: Option<f64>,
    /// The title of the law at large deformation.
    pub law: Option<String>,
}

/// The fit that made a network, and its errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FitSummaryRecord {
    /// The name of the fit.
    pub name: String,
    /// The objective.
    pub objective: String,
    /// All settings of the objective, as in report.json.
    pub settings: BTreeMap<String, serde_json::Value>,
    /// `fitted`, `stable`, `near-mechanism`, `indefinite` or `mechanism`; at large deformation `converged` or `stalled`.
    pub status: String,
    /// Springs with a constant below zero.
    pub negative_springs: usize,
    /// `‖R − K‖/‖R‖` of the elements, mean and largest; null where springs belong to no element.
    pub relative_frobenius: Option<[f64; 2]>,
    /// `‖C − C₀‖/‖C₀‖` of the elasticity tensor.
    pub relative_tensor: Option<f64>,
    /// The errors under each load of the scene.
    pub loads: Vec<LoadErrorsRecord>,
}

/// The errors of a network under a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadErrorsRecord {
    /// The name of the load.
    pub name: String,
    /// Percent of the largest displacement, as the two that follow.
    pub e_rms: Option<f64>,
    /// The largest error, percent of the largest displacement.
    pub e_max: Option<f64>,
    /// The error at the point that moves most, percent of the largest displacement.
    pub e_tip: Option<f64>,
    /// By how many percent it is softer than the finite elements, from the work of the load.
    pub e_energy: Option<f64>,
}

/// The cells of one element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CellBlockRecord<C = Vec<Vec<usize>>> {
    /// The name of the element.
    pub element: String,
    /// The type of the cells in VTK; null if the element names none.
    pub vtk: Option<u32>,
    /// Points of each cell in the order of the element, `[cells][nodes]`.
    pub points: C,
}

/// A point that is held in some directions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeldRecord {
    /// The point, from 0.
    pub point: usize,
    /// m, `[dimension]`; null in directions in which the point is free.
    pub displacement: Vec<Option<f64>>,
}

/// A load as nodal forces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodalLoadRecord {
    /// The name of the load.
    pub name: String,
    /// The forces on its points.
    pub forces: Vec<NodalForceRecord>,
    /// All points that are held under this load, with prescribed displacements.
    pub held: Vec<HeldRecord>,
}

/// The force on a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodalForceRecord {
    /// The point, from 0.
    pub point: usize,
    /// N, `[dimension]`.
    pub force: Vec<f64>,
}

/// The damping `C = α M + β K₀ + Σ_s c_s ∇c_s ∇c_sᵀ`; c_s is the `damper` of each spring.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NetworkDampingRecord {
    /// α, 1/s.
    pub mass: f64,
    /// β, s.
    pub stiffness: f64,
    /// The damping ratio from which the dampers of the springs are made; 0 if they have none.
    pub ratio: f64,
}

/// How a scene moves its network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DriveRecord {
    /// s, as the two that follow.
    pub duration: f64,
    /// The time step, s.
    pub step: f64,
    /// Between the states that are written.
    pub every: f64,
    /// The number of time steps.
    pub steps: usize,
    /// The name of the integrator.
    pub integrator: String,
    /// Whether springs keep their directions, as in linear finite elements.
    pub linear: bool,
    /// Points whose mean displacement is written.
    pub watched: Vec<usize>,
    /// Forces that act for a time.
    pub forces: Vec<TimedForceRecord>,
    /// Points that are moved for a time.
    pub pulls: Vec<TimedPullRecord>,
}

/// A force over time in one direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimedForceRecord {
    /// The direction, from 0.
    pub axis: usize,
    /// N, an expression in t.
    pub force: String,
    /// The points on which it acts, from 0.
    pub points: Vec<usize>,
    /// The share of each point, by which the force is multiplied.
    pub shares: Vec<f64>,
}

/// A displacement over time in one direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimedPullRecord {
    /// The direction, from 0.
    pub axis: usize,
    /// m, an expression in t and in the x, y, z of the point at rest.
    pub displacement: String,
    /// The points that are moved, from 0.
    pub points: Vec<usize>,
}

/// A group of springs of an element.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OriginRecord {
    /// The name of the element.
    pub element: String,
    /// The name of the group of its springs.
    pub group: String,
}

/// What a spring measures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasureRecord {
    /// What is measured.
    pub kind: MeasureKind,
    /// Of a content: the element whose shape functions have these gradients; null of fibres.
    pub element: Option<String>,
    /// Of a content: `Σ_cells share · Σ_terms weight · |Σ_a x_a ⊗ gradients_a|`, with the points of the cells.
    pub terms: Vec<TermRecord>,
    /// The cells whose contents are summed, with their shares.
    pub cells: Vec<ShareRecord>,
    /// Of an expression: a function of `x0, y0, z0, x1, …`, the coordinates of the points of the spring.
    pub expression: Option<String>,
}

/// How a measure is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MeasureKind {
    /// The distance of two points.
    Length,
    /// A sum of determinants; with fewer columns than coordinates, of the areas or lengths that they span.
    Content,
    /// An expression.
    Expression,
}

/// One point of a quadrature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TermRecord {
    /// The weight of the term in the sum.
    pub weight: f64,
    /// `[nodes][columns]`.
    pub gradients: Vec<Vec<f64>>,
}

/// A cell of a content.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShareRecord {
    /// Places in the points of the spring.
    pub nodes: Vec<usize>,
    /// The share of the content of the cell.
    pub share: f64,
}

/// A spring: it has the energy `½ k (c − rest)²` and pulls with `k (c − rest) ∇c`, or with the force of its law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringRecord<'a> {
    /// What the spring measures.
    pub kind: Cow<'a, str>,
    /// The points of which it is a function, from 0.
    pub points: Cow<'a, [usize]>,
    /// In the unit of the kind; with a law the slope of its force at rest.
    pub constant: f64,
    /// In the unit of what is measured: m, m², m³ or rad.
    pub rest: f64,
    /// The place of its measure in `measures`.
    pub measure: usize,
    /// The force as an expression of `s = (c − c0)/c0`, `c`, `c0` (the rest) and parameters; null if it is linear.
    pub law: Option<Cow<'a, str>>,
    /// Of the law, by name.
    pub parameters: BTreeMap<String, f64>,
    /// The coefficient c_s of the damper beside it: the unit of `constant`, times s.
    pub damper: f64,
    /// Places in `groups`: of all cells that share the spring.
    pub groups: Cow<'a, [usize]>,
}

impl SpringRecord<'_> {
    pub(super) fn into_owned(self) -> SpringRecord<'static> {
        SpringRecord {
            kind: Cow::Owned(self.kind.into_owned()),
            points: Cow::Owned(self.points.into_owned()),
            law: self.law.map(|law| Cow::Owned(law.into_owned())),
            groups: Cow::Owned(self.groups.into_owned()),
            ..self
        }
    }
}

/// The JSON Schema of network files.
pub fn network_schema() -> serde_json::Value {
    schema_for!(NetworkRecord).to_value()
}
