//! The element file as it is written, key by key.

use super::cell::Cell;
use super::constant::Constant;
use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    pub name: String,
    pub title: String,
    pub cell: Cell,
    /// Names of the reference coordinates, as the shape functions use them.
    pub coordinates: Vec<String>,
    /// Where the shape functions are published.
    pub source: Option<String>,
    /// Named sub-expressions, in the order of the file.
    #[serde(default, rename = "let")]
    pub definitions: toml::Table,
    pub nodes: Vec<NodeEntry>,
    pub quadrature: Rule,
    #[serde(default)]
    pub springs: Vec<SpringEntry>,
    #[serde(default)]
    pub formats: Formats,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NodeEntry {
    pub at: Vec<Constant>,
    pub shape: String,
}

#[derive(Debug, Deserialize)]
#[serde(tag = "rule", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Rule {
    GaussLegendre { points: usize },
    Simplex { degree: usize },
    Explicit { points: Vec<Vec<Constant>>, weights: Vec<Constant> },
}

/// What a spring measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpringKind {
    /// The distance of two nodes.
    Length,
    /// The area of the whole cell, in two dimensions.
    Area,
    /// The volume of the whole cell, in three dimensions.
    Volume,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpringEntry {
    pub group: String,
    pub kind: SpringKind,
    /// Node pairs of length springs.
    pub nodes: Option<Vec<Vec<usize>>>,
    /// Used only where a fit names the group.
    #[serde(default)]
    pub optional: bool,
}

/// What mesh files call the element.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Formats {
    pub gmsh: Option<FormatEntry>,
    pub vtk: Option<FormatEntry>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormatEntry {
    /// The number of the cell type.
    #[serde(rename = "type")]
    pub cell_type: u32,
    /// `order[i]` is the place of our node i in the file's list; the same order if absent.
    pub order: Option<Vec<usize>>,
}
