//! The record of a network: the keys of its JSON file, for writing, for reading and for the schema.

use super::provenance::{PlaneRecord, ProvenanceRecord};
use crate::engine::Setting;
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
    /// The format says that the file is a network.
    #[schemars(extend("const" = FORMAT))]
    pub format: String,
    /// The version of the format changes when a key is removed or its meaning changes.
    #[schemars(extend("const" = NETWORK_VERSION))]
    pub version: u32,
    /// `provenance` says where the network comes from.
    pub provenance: ProvenanceRecord,
    /// A point has this number of coordinates.
    pub dimension: usize,
    /// Units are named by quantity, and those of the constants by kind of spring.
    pub units: BTreeMap<String, String>,
    /// Points are at these positions at rest in m, `[points][dimension]`.
    pub points: Vec<Vec<f64>>,
    /// A text says what the numbers in `nodes` are; it is null of a mesh that is no file.
    pub numbering: Option<String>,
    /// Points have these numbers in the mesh file, `[points]`; the list is null of a mesh that is no file.
    pub nodes: Option<Vec<u64>>,
    /// Points have these masses in kg, `[points]`; the list is null without a density. They are those that the run computes with: fitted
    /// ones, those of the motion, or the row sums of the mass matrix. Where row sums are not positive, they are those of the HRZ method.
    pub masses: Option<Vec<f64>>,
    /// Each entry has the cells of the mesh with one element.
    pub cells: Vec<CellBlockRecord<C>>,
    /// Triangles between points are on the boundary of a solid, counterclockwise as seen from outside; for a plane mesh or a surface they
    /// are its cells.
    pub surface: Vec<[usize; 3]>,
    /// Each entry is a point that `[[fix]]` of the scene holds.
    pub held: Vec<HeldRecord>,
    /// Each entry is a load of the scene as nodal forces.
    pub loads: Vec<NodalLoadRecord>,
    /// The acceleration of `[motion]` is in m/s², `[dimension]`; it is null where the scene says nothing of it.
    pub gravity: Option<Vec<f64>>,
    /// `damping` has Rayleigh's numbers and the damping ratio.
    pub damping: NetworkDampingRecord,
    /// `motion` says how the scene moves the network; it is null without `[motion]`.
    pub motion: Option<DriveRecord>,
    /// Symplectic Euler without damping is stable below this step in s, `2/ω` of the fastest motion at rest; it is null without masses.
    pub largest_step: Option<f64>,
    /// The constants belong to these settings of an engine, which ends its sweeps early: a body with other settings has another stiffness.
    /// It is null of constants that answer like the body where equations are solved to the end.
    #[serde(default)]
    pub engine: Option<Setting>,
    /// `plane` has the state and the thickness of a plane body or a surface; it is null of others.
    #[serde(default)]
    pub plane: Option<PlaneRecord>,
    /// Each entry is a group of springs of an element, from which springs come.
    pub groups: Vec<OriginRecord>,
    /// Each entry is something that springs measure.
    pub measures: Vec<MeasureRecord>,
    /// Each sentence says what a reader must know of the fit.
    pub notes: Vec<String>,
    /// Each entry is a spring.
    pub springs: S,
}

/// The cells of one element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CellBlockRecord<C = Vec<Vec<usize>>> {
    /// The element has this name.
    pub element: String,
    /// The cells have this type in VTK; it is null if the element names none.
    pub vtk: Option<u32>,
    /// Each cell has these points in the order of the element, `[cells][nodes]`.
    pub points: C,
}

/// The number of VTK for quadrilaterals, which have as many corners as tetrahedra.
pub const QUADRILATERAL: u32 = 9;

/// A point that is held in some directions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeldRecord {
    /// The point has this place, from 0.
    pub point: usize,
    /// The prescribed displacement is in m, `[dimension]`; it is null in directions in which the point is free.
    pub displacement: Vec<Option<f64>>,
}

/// A load as nodal forces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodalLoadRecord {
    /// The load has this name.
    pub name: String,
    /// Each entry is a force on a point.
    pub forces: Vec<NodalForceRecord>,
    /// The forces include the weight of the masses under this acceleration in m/s²; it is null if the load has no gravity.
    #[serde(default)]
    pub gravity: Option<Vec<f64>>,
    /// The load is gravity and nothing else.
    #[serde(default)]
    pub is_gravity: bool,
    /// Each entry is a point that is held under this load, with `[[fix]]` and prescribed displacements.
    pub held: Vec<HeldRecord>,
}

/// The force on a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodalForceRecord {
    /// The point has this place, from 0.
    pub point: usize,
    /// The force is in N, `[dimension]`.
    pub force: Vec<f64>,
}

/// The damping `C = α M + β K₀ + Σ_s c_s ∇c_s ∇c_sᵀ`; c_s is the `damper` of each spring.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NetworkDampingRecord {
    /// Rayleigh's α is in 1/s.
    pub mass: f64,
    /// Rayleigh's β is in s.
    pub stiffness: f64,
    /// The dampers of the springs are made of this damping ratio ζ; it is 0 if they have none.
    pub ratio: f64,
}

/// How a scene moves its network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DriveRecord {
    /// The motion takes this time in s.
    pub duration: f64,
    /// A step has this length in s.
    pub step: f64,
    /// States are written this time in s apart.
    pub every: f64,
    /// The motion has this number of steps.
    pub steps: usize,
    /// The integrator has this name.
    pub integrator: String,
    /// Springs keep their directions, as in linear finite elements.
    pub linear: bool,
    /// The mean displacement of these points is written.
    pub watched: Vec<usize>,
    /// Each entry is a force in time.
    pub forces: Vec<TimedForceRecord>,
    /// Each entry is a prescribed displacement in time.
    pub pulls: Vec<TimedPullRecord>,
    /// Each entry is a term in which stress relaxes: the constants are those against a sudden strain. The list is absent if it does not relax.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub relaxation: Vec<RelaxationRecord>,
}

/// A term of a Prony series, with which stress relaxes in the motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RelaxationRecord {
    /// The term belongs to this entry of `[[material]]`, from 0; it is null where all relax alike.
    pub region: Option<usize>,
    /// This share of the shear modulus relaxes.
    pub shear: f64,
    /// This share of the bulk modulus relaxes.
    pub bulk: f64,
    /// The relaxation time is in s.
    pub time: f64,
    /// The term does not flow below this von Mises stress in Pa; it is null if it always flows.
    #[serde(rename = "yield")]
    pub yield_stress: Option<f64>,
}

/// A force over time in one direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimedForceRecord {
    /// The force has this direction, from 0.
    pub axis: usize,
    /// The force in N is an expression of t.
    pub force: String,
    /// The force acts on these points, from 0.
    pub points: Vec<usize>,
    /// The force is multiplied by this share for each point.
    pub shares: Vec<f64>,
}

/// A displacement over time in one direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimedPullRecord {
    /// The displacement has this direction, from 0.
    pub axis: usize,
    /// The displacement in m is an expression of t, and of x, y, z of the point at rest.
    pub displacement: String,
    /// These points are moved, from 0.
    pub points: Vec<usize>,
}

/// A group of springs of an element.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OriginRecord {
    /// The element has this name.
    pub element: String,
    /// The group of springs of the element has this name; in exact networks it is `pairs`, `areas`, `points` or `content`.
    pub group: String,
}

/// What a spring measures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasureRecord {
    /// The measure is computed in this way.
    pub kind: MeasureKind,
    /// A content has the shape functions of this element; it is null of fibres.
    pub element: Option<String>,
    /// A content is `Σ_cells share · Σ_terms weight · |Σ_a x_a ⊗ gradients_a|` with these terms, one for each quadrature point.
    pub terms: Vec<TermRecord>,
    /// A content is summed over these cells.
    pub cells: Vec<ShareRecord>,
    /// An expression is a function of `x0, y0, z0, x1, …`, the coordinates of the points of the spring.
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
    /// The sum of the turns of the `cells`, each times its share in m. The nodes of such a cell are the apex of a triangle, the ends a and b of an edge as the triangle runs
    /// through it, and the director of the edge. The turn is the angle about the edge from the conormal, which points out of the triangle, to the director.
    Turn,
    /// The sum of the squared distances of the two nodes of each of the `cells`, each times its share in 1/m².
    Squares,
    /// An expression.
    Expression,
}

/// One point of a quadrature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TermRecord {
    /// The term has this weight in the sum.
    pub weight: f64,
    /// The shape functions have these gradients, `[nodes][columns]`.
    pub gradients: Vec<Vec<f64>>,
}

/// A cell of a content.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShareRecord {
    /// The nodes of the cell have these places in the points of the spring.
    pub nodes: Vec<usize>,
    /// The content of the cell has this share.
    pub share: f64,
}

/// A spring: it has the energy `½ k (c − rest)²` and pulls with `k (c − rest) ∇c`, or with the force of its law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringRecord<'a> {
    /// The spring is of this kind, which says what it measures.
    pub kind: Cow<'a, str>,
    /// The spring has these points, from 0.
    pub points: Cow<'a, [usize]>,
    /// The constant k is in the unit of the kind; with a law it is the slope at rest.
    pub constant: f64,
    /// The rest measure c₀ is in the unit of what is measured: m, m², m³ or rad.
    pub rest: f64,
    /// The measure of the spring has this place in `measures`.
    pub measure: usize,
    /// The tension is this expression of `s = (c − c0)/c0`, `c`, `c0` (the rest) and parameters; it is null if it is linear.
    pub law: Option<Cow<'a, str>>,
    /// The parameters of the law have these values.
    pub parameters: BTreeMap<String, f64>,
    /// The damper beside the spring has this coefficient c_s, in the unit of `constant` times s.
    pub damper: f64,
    /// The cells that share the spring have these places in `groups`; the list is empty for springs of patches and across cells.
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
