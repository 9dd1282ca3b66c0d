//! The record of a page: all that its scripts read.

use super::array::{Floats, Places};
use crate::report::json::Report;
use crate::report::object::Object;
use crate::report::table::Table;
use serde::Serialize;

/// All that a page shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PageRecord {
    /// The program and its version.
    pub program: String,
    /// The command that was given.
    pub command: Option<String>,
    /// Where the mesh comes from, in words.
    pub mesh: String,
    /// `plane stress`, `plane strain`, `rod` or `solid`.
    pub state: String,
    /// The keys of `report.json`.
    pub report: Report,
    /// What a reader must know, the dearest first: one sentence for all models that it concerns.
    pub notes: Vec<String>,
    /// The tables of the report.
    pub tables: Vec<Table>,
    /// The body and its networks as pictures.
    pub view: ViewRecord,
}

/// The body and its networks. Points are places among those that are drawn, and have three coordinates whatever the body.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ViewRecord {
    /// The number of coordinates of a point of the body.
    pub dimension: usize,
    /// `[points × 3]`, m.
    pub points: Floats,
    /// The numbers of the points in the mesh file, from 0 in a mesh that is no file.
    pub numbers: Places,
    /// Edges of the cells on the surface, `[edges × 2]`.
    pub edges: Places,
    /// The surface, `[triangles × 3]`.
    pub triangles: Places,
    /// The loads of the body: each has its name, with the share of it that the finite elements reached if that is not all, and their
    /// displacements, `[points × 3]`, m.
    pub loads: Vec<Object>,
    /// Springs between two points, which networks may have in common.
    pub meshes: Vec<SpringMeshRecord>,
    /// The networks in the order of the fits.
    pub networks: Vec<NetworkViewRecord>,
    /// The motion of the models that have states: the times, s, `[states]`, and of each model the place of its network, null of the finite
    /// elements, with its displacements in each state, `[points × 3]`, m; fewer than times where the motion broke off.
    pub motion: Option<Object>,
    /// What is not drawn, one sentence each.
    pub left_out: Vec<String>,
}

/// Springs between two points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpringMeshRecord {
    /// `[springs × 2]`.
    pub ends: Places,
    /// The places of the springs in the network's files.
    pub numbers: Places,
}

/// A network.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NetworkViewRecord {
    /// The name of its fit.
    pub name: String,
    /// The place of its springs in `meshes`.
    pub mesh: usize,
    /// N/m, `[springs]`.
    pub constants: Floats,
    /// m, `[springs]`.
    pub rests: Floats,
    /// For each load the displacements, `[points × 3]`, m; null where the network has none.
    pub displacements: Vec<Option<Floats>>,
    /// How the constants of each kind of spring are distributed.
    pub histograms: Vec<HistogramRecord>,
}

/// How many springs have a constant within each of some intervals of the same width.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HistogramRecord {
    /// The kind of the springs.
    pub kind: String,
    /// The constants have this unit.
    pub unit: String,
    /// The least and the largest constant.
    pub range: [f64; 2],
    /// The lower end of the first interval, and their width.
    pub first: f64,
    /// Each interval has this width, in the unit of the constants.
    pub width: f64,
    /// Springs in each interval.
    pub counts: Vec<usize>,
    /// Springs below and above all intervals.
    pub outside: [usize; 2],
}
