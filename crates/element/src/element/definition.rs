//! The structure of an element file, key by key, before it is checked.

use super::cell::Cell;
use super::constant::Constant;
use super::kind::SpringKind;
use crate::file::Forms;
use schemars::{JsonSchema, Schema, schema_for};
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny};
use serde_json::Value;
use std::collections::BTreeMap;

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    /// The name is a short one, which tables and files show.
    pub name: String,
    /// The title is a headline.
    pub title: String,
    /// The element has this reference cell. Intervals and boxes span [−1, 1]; simplices are the unit corner; a wedge is the triangle times
    /// [−1, 1]; a pyramid has the square as its base and its apex at (0, 0, 1).
    pub cell: Cell,
    /// The reference coordinates have these names in the shape functions.
    pub coordinates: Vec<String>,
    /// The shape functions are published there.
    pub source: Option<String>,
    /// Parts of expressions have these names; each may use those before it.
    #[serde(default, rename = "let")]
    #[schemars(with = "BTreeMap<String, String>")]
    pub definitions: toml::Table,
    /// Each node has a place and a shape function.
    pub nodes: Vec<NodeEntry>,
    /// The stiffness is integrated by this rule. Loads and masses have rules of the degree that they need.
    pub quadrature: Rule,
    /// The term λ (div u)² of the stiffness is integrated by this rule, which is selective integration.
    #[schemars(extend("x-default" = "`quadrature`"))]
    pub volumetric_quadrature: Option<Rule>,
    /// Each entry is a group of springs.
    #[serde(default)]
    pub springs: Vec<SpringEntry>,
    /// `formats` has what mesh files call the element.
    #[serde(default)]
    pub formats: Formats,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodeEntry {
    /// The node is at this place of the reference cell, numbers or constants such as `"1/3"` and `"sqrt(3)/3"`.
    #[serde(default)]
    #[schemars(extend("x-default" = "none, with `condense`"))]
    pub at: Vec<Constant>,
    /// The shape function is 1 at the node and 0 at the others.
    pub shape: String,
    /// The function belongs to no node: it is 0 at all of them, and its amplitude is the one of least energy in each cell. Such functions,
    /// bubbles and incompatible modes, come after the nodes.
    #[serde(default)]
    pub condense: bool,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "rule", rename_all = "kebab-case", deny_unknown_fields)]
#[schemars(transform = describe_tag)]
pub enum Rule {
    GaussLegendre {
        /// The rule has this number of points in each direction.
        points: usize,
    },
    Simplex {
        /// Polynomials up to this degree are integrated exactly.
        degree: usize,
    },
    Degree {
        /// Polynomials up to this degree are integrated exactly.
        degree: usize,
    },
    Explicit {
        /// The points are at these places of the reference cell.
        points: Vec<Vec<Constant>>,
        /// The points have these weights.
        weights: Vec<Constant>,
    },
}

/// The tag is no field, which would have a comment.
fn describe_tag(schema: &mut Schema) {
    let rules = schema.get_mut("oneOf").and_then(Value::as_array_mut).into_iter().flatten();
    for tag in rules.filter_map(|rule| rule.pointer_mut("/properties/rule")) {
        tag["description"] =
            "The rule is `gauss-legendre` for intervals, quadrilaterals and hexahedra, `simplex` for triangles and \
                              tetrahedra, or `degree` or `explicit` for all cells."
                .into();
    }
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringEntry {
    /// The springs are a group of this name.
    pub group: String,
    /// The springs measure a length, an angle, or another of these kinds.
    pub kind: SpringKind,
    /// Each spring has one of these lists of nodes, from 0; `"complete"` takes all pairs of nodes that have no spring yet, and with the kind
    /// `angle` the angles between all edges that meet at a corner.
    #[schemars(extend("x-type" = "lists of indices, or `\"complete\"`", "x-default" = "the whole cell"))]
    pub nodes: Option<NodeLists>,
    /// A spring of the kind `measure` has this expression of `x0, y0, z0, x1, …`, the coordinates of its nodes.
    pub measure: Option<String>,
    /// `auto` divides the springs into classes that the symmetry of the cell maps onto each other, one group for each class.
    pub class: Option<SpringClass>,
    /// The group is used by fits that name it, and by no others.
    #[serde(default)]
    pub optional: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpringClass {
    Auto,
}

/// Lists of nodes, or `"complete"`: all pairs of nodes, or all angles between edges at a corner, that have no spring yet.
#[derive(Debug, JsonSchema)]
#[schemars(untagged)]
pub enum NodeLists {
    Named(String),
    Given(Vec<Vec<usize>>),
}

impl<'de> Deserialize<'de> for NodeLists {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<NodeLists, D::Error> {
        deserializer.deserialize_any(Forms::<_, _, IgnoredAny> {
            text: Some(&|name| Ok(NodeLists::Named(name.into()))),
            list: Some(|lists| Ok(NodeLists::Given(lists))),
            ..Forms::expecting("lists of nodes, or \"complete\"")
        })
    }
}

/// The JSON Schema of element files.
pub fn schema() -> serde_json::Value {
    schema_for!(Definition).to_value()
}

/// What mesh files call the element.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Formats {
    /// Gmsh files have the element as this type.
    pub gmsh: Option<FormatEntry>,
    /// VTK files have the element as this type.
    pub vtk: Option<FormatEntry>,
}

/// A cell type of a mesh format, with the order in which the format lists the nodes.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FormatEntry {
    /// The type of cells has this number in the format.
    #[serde(rename = "type")]
    pub cell_type: u32,
    /// `order[i]` is the place of node i of the element in the list of the file.
    #[schemars(extend("x-default" = "the same order"))]
    pub order: Option<Vec<usize>>,
}
