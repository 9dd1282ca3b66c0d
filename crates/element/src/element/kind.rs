//! The kinds of springs, one row of properties for each.
//!
//! Theory: pages *Stiffness and the reduced space* and *Exact networks and patches* of the book.

use super::formula::Formula;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// What a spring measures. Its energy is ½ k (c − c₀)², with c the measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpringKind {
    /// The distance of two nodes, in m.
    Length,
    /// The angle at the second of three nodes, in rad.
    Angle,
    /// The area of a polygon of nodes, or of the whole cell in two dimensions, in m².
    Area,
    /// The volume of a tetrahedron of nodes, or of the whole cell in three dimensions, in m³.
    Volume,
    /// The sum of the distances a-b and c-d of four nodes, in m. Its square contains the product of the two
    /// elongations.
    Coupling,
    /// An expression in the coordinates of the nodes, given by the element file.
    Measure,
    /// The part of the content of a cell that belongs to one quadrature point: a length in m, an area in m², a volume
    /// in m³. Exact networks have such springs; an element file cannot ask for them.
    #[serde(skip)]
    PointContent,
    /// The area of the parallelogram that two tangents of a cell span at a quadrature point, in m². For exact networks
    /// only.
    #[serde(skip)]
    PointArea,
    /// A weighted sum of the contents of the cells around a node, in m² or m³. For exact networks only.
    #[serde(skip)]
    Patch,
    /// The stretch of the fibres at a quadrature point of a cell. For exact networks only.
    #[serde(skip)]
    Fibre,
    /// A weighted sum of the turns of a triangle from the directors of its edges, or of a rod from those of its ends, in m. For sheets and rods that bend only.
    #[serde(skip)]
    Bend,
    /// The turn of a triangle about one of its edges, from its plane to a director or to the apex of another triangle, in rad, or of a rod. For sheets and rods that bend only.
    #[serde(skip)]
    Hinge,
    /// A weighted sum of the squared distances of some pairs of points: a component of the strain of a surface at an edge. For exact networks only.
    #[serde(skip)]
    Strain,
}

crate::named!(SpringKind {
    "length" => Length,
    "angle" => Angle,
    "area" => Area,
    "volume" => Volume,
    "coupling" => Coupling,
    "measure" => Measure,
    "point-content" => PointContent,
    "point-area" => PointArea,
    "patch" => Patch,
    "fibre" => Fibre,
    "bend" => Bend,
    "hinge" => Hinge,
    "strain" => Strain,
});

/// The longest list of nodes of a spring, that of the polygon of an area.
const MOST_NODES: usize = 8;

/// The properties of a kind of springs.
#[non_exhaustive]
pub struct Kind {
    /// How many nodes a spring may have.
    pub nodes: RangeInclusive<usize>,
    /// The least dimension of the cell.
    pub least_dimension: usize,
    /// The dimension of the cells whose content a spring without nodes measures; none for other kinds.
    pub content: Option<usize>,
    /// The orders of the nodes in which a spring measures the same.
    pub symmetry: Symmetry,
    /// Whether an element file can ask for such springs.
    pub in_element_files: bool,
    /// The unit of a spring constant: J divided by the square of the unit of the measure.
    pub unit: &'static str,
    /// The measure as a formula, if the kind alone determines it.
    pub(crate) formula: Option<fn(&Formula) -> String>,
}

/// The orders of the nodes in which a spring measures the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// All orders.
    Any,
    /// The given order, and the one with the first and last node exchanged.
    Ends,
    /// The nodes of each of two pairs may be exchanged, and the pairs.
    Pairs,
    /// The given order only.
    Ordered,
}

impl SpringKind {
    /// The properties of the kind.
    pub fn properties(self) -> Kind {
        // What a kind has unless its row says otherwise.
        let other = Kind {
            nodes: 1..=MOST_NODES,
            least_dimension: 1,
            content: None,
            symmetry: Symmetry::Ordered,
            in_element_files: false,
            unit: "J per square of the unit of the measure",
            formula: None,
        };
        match self {
            SpringKind::Length => Kind {
                nodes: 2..=2,
                symmetry: Symmetry::Any,
                in_element_files: true,
                unit: "N/m",
                formula: Some(|formula| formula.distance(0, 1)),
                ..other
            },
            SpringKind::Angle => Kind {
                nodes: 3..=3,
                least_dimension: 2,
                symmetry: Symmetry::Ends,
                in_element_files: true,
                unit: "N*m",
                formula: Some(Formula::angle),
                ..other
            },
            SpringKind::Area => Kind {
                nodes: 3..=MOST_NODES,
                least_dimension: 2,
                content: Some(2),
                symmetry: Symmetry::Any,
                in_element_files: true,
                unit: "N/m^3",
                formula: Some(Formula::area),
            },
            SpringKind::Volume => Kind {
                nodes: 4..=4,
                least_dimension: 3,
                content: Some(3),
                symmetry: Symmetry::Any,
                in_element_files: true,
                unit: "N/m^5",
                formula: Some(Formula::volume),
            },
            SpringKind::Coupling => Kind {
                nodes: 4..=4,
                symmetry: Symmetry::Pairs,
                in_element_files: true,
                unit: "N/m",
                formula: Some(|formula| format!("{} + {}", formula.distance(0, 1), formula.distance(2, 3))),
                ..other
            },
            SpringKind::Measure => Kind { in_element_files: true, ..other },
            SpringKind::Bend => Kind { nodes: 6..=6, least_dimension: 3, unit: "N/m", ..other },
            SpringKind::Hinge => Kind { nodes: 4..=4, least_dimension: 3, unit: "N*m", ..other },
            SpringKind::Strain => Kind { nodes: 3..=4, least_dimension: 2, unit: "N*m", ..other },
            SpringKind::PointContent | SpringKind::PointArea | SpringKind::Patch | SpringKind::Fibre => other,
        }
    }
}

impl Symmetry {
    /// One list that represents all orders in which a spring measures the same.
    pub fn representative(self, nodes: &[usize]) -> Vec<usize> {
        match self {
            Symmetry::Any => {
                let mut sorted = nodes.to_vec();
                sorted.sort_unstable();
                sorted
            }
            Symmetry::Ends => {
                let ends = pair(&[nodes[0], nodes[2]]);
                vec![nodes[1], ends[0], ends[1]]
            }
            Symmetry::Pairs => {
                let mut pairs = [pair(&nodes[..2]), pair(&nodes[2..])];
                pairs.sort_unstable();
                pairs.concat()
            }
            Symmetry::Ordered => nodes.to_vec(),
        }
    }

    /// Whether the nodes that have to differ do so.
    pub(super) fn are_different(self, nodes: &[usize]) -> bool {
        match self {
            Symmetry::Pairs => nodes[0] != nodes[1] && nodes[2] != nodes[3] && pair(&nodes[..2]) != pair(&nodes[2..]),
            Symmetry::Any | Symmetry::Ends | Symmetry::Ordered => {
                (0..nodes.len()).all(|j| !nodes[..j].contains(&nodes[j]))
            }
        }
    }
}

fn pair(nodes: &[usize]) -> [usize; 2] {
    [nodes[0].min(nodes[1]), nodes[0].max(nodes[1])]
}
