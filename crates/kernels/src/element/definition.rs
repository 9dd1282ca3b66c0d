//! The structure of an element file, key by key, before it is checked.

use super::cell::Cell;
use super::constant::Constant;
use super::kind::SpringKind;
use schemars::{JsonSchema, schema_for};
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    pub name: String,
    pub title: String,
    pub cell: Cell,
    /// Names of the reference coordinates in the shape functions.
    pub coordinates: Vec<String>,
    /// Where the shape functions are published.
    pub source: Option<String>,
    /// Named sub-expressions, in the order of the file.
    #[serde(default, rename = "let")]
    #[schemars(with = "BTreeMap<String, String>")]
    pub definitions: toml::Table,
    pub nodes: Vec<NodeEntry>,
    pub quadrature: Rule,
    /// The quadrature rule of the term λ (div u)²; if it is absent, the rule of all other terms.
    pub volumetric_quadrature: Option<Rule>,
    #[serde(default)]
    pub springs: Vec<SpringEntry>,
    #[serde(default)]
    pub formats: Formats,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodeEntry {
    pub at: Vec<Constant>,
    pub shape: String,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "rule", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Rule {
    GaussLegendre { points: usize },
    Simplex { degree: usize },
    Degree { degree: usize },
    Explicit { points: Vec<Vec<Constant>>, weights: Vec<Constant> },
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringEntry {
    pub group: String,
    pub kind: SpringKind,
    /// The nodes of each spring; absent if the whole cell is measured.
    pub nodes: Option<NodeLists>,
    /// For the kind `measure`: a function of the coordinates `x0, y0, z0, x1, …` of the nodes of one spring.
    pub measure: Option<String>,
    /// `auto` divides the springs into classes that the symmetry of the cell maps onto each other, one group for each
    /// class.
    pub class: Option<SpringClass>,
    /// Whether the group is used only by fits that name it.
    #[serde(default)]
    pub optional: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpringClass {
    Auto,
}

/// Lists of nodes, or `"complete"`: all pairs of nodes that have no spring yet.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "lists of nodes, or \"complete\"")]
pub enum NodeLists {
    Named(String),
    Given(Vec<Vec<usize>>),
}

/// The JSON Schema of element files.
pub fn schema() -> serde_json::Value {
    schema_for!(Definition).to_value()
}

/// What mesh files call the element.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Formats {
    /// The type in Gmsh files.
    pub gmsh: Option<FormatEntry>,
    /// The type in VTK files.
    pub vtk: Option<FormatEntry>,
}

/// A cell type of a mesh format, with the order in which the format lists the nodes.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FormatEntry {
    /// The number of the cell type.
    #[serde(rename = "type")]
    pub cell_type: u32,
    /// `order[i]` is the position of node i of the element in the list of the file. If it is absent, the orders are
    /// equal.
    pub order: Option<Vec<usize>>,
}
