//! Finite elements read from text: a cell, nodal shape functions, a quadrature rule and groups of springs.
//!
//! No element is named in the code. The files of the folder `elements` are embedded in the program; files of users have
//! the same rights. [`Element::load`] proves the properties that every other module relies on.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

mod bounds;
mod cell;
mod condensing;
mod constant;
mod definition;
mod formula;
mod groups;
mod integrand;
mod invariance;
mod kind;
mod modes;
mod outline;
mod proof;
mod quadrature;
mod rational;
mod symmetry;
mod tabulation;

pub use bounds::JacobianBounds;
pub use cell::{Cell, Side, same_place};
pub use definition::{FormatEntry, Formats, schema};
pub use formula::coordinate_names;
pub(crate) use formula::{Formula, dot};
pub use groups::SpringGroup;
pub use integrand::Integrand;
pub use kind::{Kind, SpringKind, Symmetry};
pub use modes::Modes;
pub use outline::Outline;
pub use quadrature::Quadrature;
pub use springfit_shipped::{ELEMENTS as SHIPPED, ElementFile};
pub use symmetry::permutations;
pub use tabulation::{ShapeFunctions, Tabulation};

use crate::error::{Error, ErrorKind, Result};
use crate::file;
use crate::named::unknown;
use crate::symbolic::{Polynomial, Scope};
use definition::Definition;
use groups::spring_groups;
use num_rational::BigRational;
use std::path::Path;
use std::sync::OnceLock;

/// An element whose file has been checked: Kronecker property, partition of unity, linear completeness, quadrature,
/// springs.
#[derive(Debug, Clone)]
pub struct Element {
    /// The name in files and options.
    pub name: String,
    /// The name in headings.
    pub title: String,
    /// Where the shape functions are published.
    pub source: Option<String>,
    /// The reference cell.
    pub cell: Cell,
    /// The names of the reference coordinates.
    pub coordinates: Vec<String>,
    /// Reference positions of the nodes, `[nodes × dimension]`.
    pub positions: Vec<f64>,
    /// The reference positions as exact numbers, if all are rational.
    pub rational_positions: Option<Vec<BigRational>>,
    /// The shape functions with their symbolic gradients.
    pub functions: ShapeFunctions,
    /// The shape functions at the points of the element's own quadrature rule.
    pub tabulation: Tabulation,
    /// The groups of springs, in the order of the file.
    pub springs: Vec<SpringGroup>,
    /// The cell types in mesh files.
    pub formats: Formats,
    /// The order of the nodes that turns the element inside out, if there is one.
    pub reflection: Option<Vec<usize>>,
    sides: OnceLock<Vec<SideTable>>,
    /// The degree of the shape functions on which the rules of loads and masses are based.
    order: OnceLock<usize>,
}

/// A side of the element: its nodes, and the shape functions along it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SideTable {
    /// The nodes of the element that are on the side.
    pub nodes: Vec<usize>,
    /// The shape functions of these nodes, and their derivatives along the side.
    pub tabulation: Tabulation,
}

impl Element {
    /// The shipped element of linear simplices of this dimension: bars, triangles or tetrahedra with nodes at their corners alone.
    ///
    /// # Errors
    /// No shipped element is such a simplex; or a shipped file is wrong, which tests exclude.
    pub fn linear_simplex(dimension: usize) -> Result<Element> {
        for file in SHIPPED {
            let element = Element::shipped(file)?;
            if element.dimension() == dimension && element.nodes() == dimension + 1 {
                return Ok(element);
            }
        }
        Err(Error::expected("dimension", "1, 2 or 3", dimension))
    }

    /// The shipped element with this name, or the element in the file at this path.
    ///
    /// # Errors
    /// There is no such element, or its file is wrong.
    pub fn load(name_or_path: &str) -> Result<Element> {
        if name_or_path.ends_with(".toml") {
            let path = Path::new(name_or_path);
            return Element::parse(&file::read_text(path)?).map_err(|e| e.in_file(path));
        }
        match SHIPPED.iter().find(|s| s.name == name_or_path) {
            Some(file) => Element::shipped(file),
            None => {
                let names: Vec<_> = SHIPPED.iter().map(|s| s.name).collect();
                let expected = format!("one of {}, or a path that ends in .toml", names.join(", "));
                Err(unknown(expected, names, name_or_path).at_key("element"))
            }
        }
    }

    /// The element of a shipped file.
    ///
    /// # Errors
    /// None for the shipped files, which are all tested.
    pub fn shipped(file: &ElementFile) -> Result<Element> {
        Element::parse(file.text).map_err(|e| e.in_file(Path::new(&format!("elements/{}.toml", file.name))))
    }

    /// Parses the text of an element file and proves its properties.
    ///
    /// # Errors
    /// The text is wrong. The error names the line and the key, what was expected and what was found.
    pub fn parse(text: &str) -> Result<Element> {
        Element::proved(text).map_err(|e| file::on_line_of_key(e, text))
    }

    fn proved(text: &str) -> Result<Element> {
        let mut definition: Definition = file::parse_toml(text)?;
        let condensed = condensing::take(&mut definition)?;
        let dimension = definition.cell.dimension();
        proof::names(&definition)?;
        proof::coordinates(&definition)?;
        let mut scope = Scope::new(&definition.coordinates);
        for (name, value) in &definition.definitions {
            let text = value
                .as_str()
                .ok_or_else(|| Error::expected(format!("let.{name}"), "an expression in quotes", value.type_str()))?;
            scope.define(name, text).map_err(|e| e.under(format!("let.{name}")))?;
        }
        let mut values = Vec::new();
        for (a, node) in definition.nodes.iter().enumerate() {
            values.push(scope.expression(&node.shape).map_err(|e| e.under(format!("nodes[{a}].shape")))?);
        }
        let mut beside = Vec::new();
        for (a, mode) in (definition.nodes.len()..).zip(&condensed) {
            beside.push(scope.expression(&mode.shape).map_err(|e| e.under(format!("nodes[{a}].shape")))?);
        }
        proof::moderate(&definition, &[&values[..], &beside].concat())?;
        proof::nodal(&definition, &values)?;
        let rule = proof::quadrature(&definition, &definition.quadrature, "quadrature")?;
        let volumetric = definition.volumetric_quadrature.as_ref();
        let volumetric = volumetric.map(|r| proof::quadrature(&definition, r, "volumetric_quadrature")).transpose()?;
        let positions: Vec<f64> = definition.nodes.iter().flat_map(|n| n.at.iter().map(|c| c.value())).collect();
        let rational_positions = definition.nodes.iter().flat_map(|n| n.at.iter().map(|c| c.exact())).collect();
        let springs = spring_groups(&definition, &positions)?;
        proof::formats(&definition)?;

        let functions = ShapeFunctions::new(values, dimension);
        proof::tabulable(&functions, rule.weights.len() + volumetric.as_ref().map_or(0, |r| r.weights.len()))?;
        let mut tabulation = Tabulation::new(&functions, &rule, volumetric.as_ref());
        proof::finite(&tabulation)?;
        tabulation.modes =
            condensing::tabulate(&definition, beside, &functions, &tabulation, (&rule, volumetric.as_ref()))?;
        Ok(Element {
            reflection: reflection(&positions, dimension),
            name: definition.name,
            title: definition.title,
            source: definition.source,
            cell: definition.cell,
            coordinates: definition.coordinates,
            positions,
            rational_positions,
            functions,
            tabulation,
            springs,
            formats: definition.formats,
            sides: OnceLock::new(),
            order: OnceLock::new(),
        })
    }

    /// The number of reference coordinates.
    pub fn dimension(&self) -> usize {
        self.cell.dimension()
    }

    /// Whether the nodes are the corners of the cell alone, so that its edges are straight.
    pub fn has_corners_alone(&self) -> bool {
        self.nodes() == self.cell.corners().len()
    }

    /// The number of functions beside those of the nodes, whose amplitudes are condensed cell by cell.
    pub fn modes(&self) -> usize {
        self.tabulation.modes.as_ref().map_or(0, |modes| modes.count())
    }

    /// Checks that no function is condensed.
    ///
    /// # Errors
    /// Some are; `what` cannot be had of such an element: kind `Unsupported`.
    pub fn check_plain(&self, what: &str) -> Result<()> {
        match self.modes() {
            0 => Ok(()),
            count => {
                let expected = format!("an element without condensed functions for {what}");
                let found = format!("{} with {count}", self.name);
                Err(Error::expected("element", expected, found).of_kind(ErrorKind::Unsupported))
            }
        }
    }

    /// The number of nodes.
    pub fn nodes(&self) -> usize {
        self.functions.values.len()
    }

    /// The number of coordinates of a node; more than the dimension for a cell of a surface or curve.
    pub fn space(&self) -> usize {
        self.tabulation.space
    }

    /// Makes the element a piece of a surface or curve in a space of more dimensions.
    pub fn in_space(mut self, space: usize) -> Element {
        self.tabulation.space = space.max(self.dimension());
        self
    }

    /// Whether the element has motions other than those of constant strain.
    pub fn has_higher_modes(&self) -> bool {
        self.nodes() > self.dimension() + 1
    }

    /// The node at a corner of the cell, if there is one.
    pub fn corner_node(&self, corner: usize) -> Option<usize> {
        self.cell.corner_node(corner, &self.positions)
    }

    /// One table per side, in the order of the sides of the cell. It is exact for a constant traction on flat sides.
    pub fn sides(&self) -> &[SideTable] {
        self.sides.get_or_init(|| self.cell.sides().iter().map(|side| self.side_table(side)).collect())
    }

    fn side_table(&self, side: &Side) -> SideTable {
        let d = self.dimension();
        let (origin, tangents) = side.embedding(self.cell);
        let on_side =
            |a: &usize| cell::height(&self.positions[a * d..(a + 1) * d], &origin, &tangents).abs() < cell::SAME;
        let nodes: Vec<usize> = (0..self.nodes()).filter(on_side).collect();
        let tabulation = self.side_tabulation(side, &nodes, 2 * self.degree());
        SideTable { nodes, tabulation }
    }

    /// The shape functions of `nodes` along the side, at the points of the rule of this degree.
    fn side_tabulation(&self, side: &Side, nodes: &[usize], degree: usize) -> Tabulation {
        let d = self.dimension();
        let (origin, tangents) = side.embedding(self.cell);
        let local = Quadrature::of_degree(side.cell, degree);
        let points = local
            .points
            .chunks_exact(d - 1)
            .flat_map(|s| {
                (0..d)
                    .map(|l| origin[l] + s.iter().zip(&tangents).map(|(s, t)| s * t[l]).sum::<f64>())
                    .collect::<Vec<_>>()
            })
            .collect();
        let rule = Quadrature { dimension: d, points, weights: local.weights };
        let functions = ShapeFunctions {
            values: nodes.iter().map(|&a| self.functions.values[a].clone()).collect(),
            gradients: nodes.iter().map(|&a| self.functions.gradients[a].clone()).collect(),
        };
        Tabulation::new(&functions, &rule, None).along(&tangents)
    }

    /// Whether all shape functions are polynomials.
    pub fn is_polynomial(&self) -> bool {
        self.functions.values.iter().all(|n| Polynomial::expand(n, self.dimension()).is_some())
    }

    /// The largest degree of a shape function; the number of nodes if one is not a polynomial.
    fn degree(&self) -> usize {
        let degree = |n| Polynomial::expand(n, self.dimension()).map_or(self.nodes(), |p| p.degree() as usize);
        self.functions.values.iter().map(degree).max().unwrap_or(1)
    }

    /// The groups that a fit uses: the named ones, or all that are not optional. The name of an entry that is divided into classes
    /// names all of them. One of [`GROUP_CHOICES`] alone stands for the groups of any element, unless a group has that name.
    ///
    /// # Errors
    /// The element has no group of this name, or no springs on its content where these are to be among them.
    pub fn select_groups(&self, names: Option<&[String]>) -> Result<Vec<&SpringGroup>> {
        let Some(names) = names else { return Ok(self.springs.iter().filter(|g| !g.optional).collect()) };
        let is_named = |group: &SpringGroup, name: &String| group.name == *name || group.entry == *name;
        if let [one] = names
            && !self.springs.iter().any(|group| is_named(group, one))
            && GROUP_CHOICES.contains(&one.as_str())
        {
            let has_content = self.springs.iter().any(SpringGroup::is_content);
            let kept = |group: &&SpringGroup| match one.as_str() {
                "default" => !group.optional,
                "all" => !group.is_content(),
                _ => true,
            };
            if one == "all + volume" && !has_content {
                let expected = format!("\"default\" or \"all\", for {} has no springs on its content", self.name);
                return Err(Error::expected("springs", expected, "\"all + volume\""));
            }
            return Ok(self.springs.iter().filter(kept).collect());
        }
        if let Some(wrong) = names.iter().find(|n| !self.springs.iter().any(|g| is_named(g, n))) {
            let known: Vec<_> = self.springs.iter().map(|g| format!("\"{}\"", g.name)).collect();
            let expected = format!("groups of {}: {}", self.name, known.join(", "));
            let groups = self.springs.iter().flat_map(|g| [g.name.as_str(), g.entry.as_str()]);
            return Err(unknown(expected, groups, wrong).at_key("springs"));
        }
        Ok(self.springs.iter().filter(|g| names.iter().any(|name| is_named(g, name))).collect())
    }
}

/// Words for groups of any element: those that are not optional; all between two points; all, with those on the content of the cell.
pub const GROUP_CHOICES: [&str; 3] = ["default", "all", "all + volume"];

/// A map of the cell onto itself that turns it inside out: it exchanges the first two reference coordinates, or else
/// mirrors the first one.
fn reflection(positions: &[f64], dimension: usize) -> Option<Vec<usize>> {
    let nodes: Vec<&[f64]> = positions.chunks_exact(dimension).collect();
    let swapped = |at: &[f64]| {
        let mut image = at.to_vec();
        if dimension > 1 {
            image.swap(0, 1);
        }
        image
    };
    let mirrored = |at: &[f64]| {
        let mut image = at.to_vec();
        image[0] = -image[0];
        image
    };
    let find = |image: Vec<f64>| nodes.iter().position(|other| same_place(other, &image));
    let first: Option<Vec<usize>> = nodes.iter().map(|at| find(swapped(at))).collect();
    let turns = |order: &Vec<usize>| order.iter().enumerate().any(|(a, b)| a != *b);
    first.filter(turns).or_else(|| nodes.iter().map(|at| find(mirrored(at))).collect())
}
