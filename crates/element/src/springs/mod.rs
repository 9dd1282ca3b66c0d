//! The springs of an element. Each measures one number c(x) of the positions of its nodes and pulls with k (c − c₀)
//! along g = ∇c.
//!
//! At rest the tangent stiffness is `K(k) = Σ_s k_s g_s g_sᵀ`, so that a fit needs only the gradients g of the springs.
//!
//! Theory: pages *Stiffness and the reduced space* and *Exact networks and patches* of the book.

mod angle;
mod areas;
mod content;
mod functions;
mod law;
mod measure;
mod patch;
mod rational;
mod squares;
mod turns;
mod vector;
mod weighted;

pub use content::Content;
pub use law::AskedResponse;
pub use law::{AskedForces, Force, ForceFunction, Law, LawJet, LawRoom};
pub use measure::{Measure, SpringResponse, linear};
pub use patch::Patch;
pub use squares::Squares;
pub use turns::{BEND_POINTS, HINGE_POINTS, Turns, turn_points};
pub use vector::{cross, distance, dot, norm, unit};
pub use weighted::Weighted;

use self::areas::area_tables;
use crate::element::{Element, SpringKind, Tabulation};
use crate::error::{Error, ErrorKind, Result};
use crate::stiffness::Geometry;
use crate::symbolic::Compiled;
use std::sync::Arc;

/// The springs of one element type that a fit uses.
///
/// Their order is: length springs; springs that measure a function of some nodes; the springs of exact networks, on
/// areas and then on contents at quadrature points; and at most one spring on the content of the whole cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Springs {
    /// The dimension of the cell.
    dimension: usize,
    /// The number of coordinates of a node; more than the dimension on surfaces and curves.
    space: usize,
    nodes: usize,
    /// The node pairs of the length springs.
    pairs: Vec<[usize; 2]>,
    /// Springs on angles, areas, volumes, couplings and users' expressions.
    functions: Vec<FunctionSpring>,
    /// What the area springs of exact networks measure: each is a table with a single point and two tangents.
    areas: Vec<Arc<Tabulation>>,
    /// The quadrature points at which springs of exact networks measure the content.
    points: Vec<usize>,
    /// The kind of the last spring, if it measures the area or volume of the cell.
    content: Option<SpringKind>,
    /// The group of each spring, as an index into `names`.
    groups: Vec<usize>,
    names: Vec<String>,
    /// Pairs `(s, t)`, s < t, of length springs that share a node, for which `(g_s · g_t)² = (n_s · n_t)²`; all other
    /// pairs are orthogonal.
    touching: Vec<(usize, usize)>,
    /// Those of these pairs that join the same two nodes.
    parallel: Vec<(usize, usize)>,
    /// Whether the element has condensed functions, so that its stiffness is no sum over products of the gradients of its nodes.
    condensed: bool,
}

/// A spring on a function of the positions of some nodes of the element.
#[derive(Debug, Clone, PartialEq)]
pub struct FunctionSpring {
    /// What it measures.
    pub kind: SpringKind,
    /// The nodes of the element, in the order of the function's coordinates.
    pub nodes: Vec<usize>,
    /// The function of the coordinates of these nodes.
    pub function: Arc<Compiled>,
    /// On a surface or curve in space: the same measure as a function of the coordinates in space.
    pub in_space: Option<Arc<Compiled>>,
}

impl Springs {
    /// The named groups of the element, or all that are not optional.
    ///
    /// # Errors
    /// The element has no group of this name, or a group requires a cell that fills its space.
    pub fn select(element: &Element, names: Option<&[String]>) -> Result<Springs> {
        let mut chosen = element.select_groups(names)?;
        // Constants are listed by kind of measure everywhere: lengths first, the content last. The sort is stable, so
        // that groups of one kind stay in the order of the file.
        chosen.sort_by_key(|g| (g.kind != SpringKind::Length, g.is_content()));
        let mut springs = Springs {
            dimension: element.dimension(),
            space: element.space(),
            nodes: element.nodes(),
            pairs: Vec::new(),
            functions: Vec::new(),
            areas: Vec::new(),
            points: Vec::new(),
            content: None,
            groups: Vec::new(),
            names: chosen.iter().map(|g| g.name.clone()).collect(),
            touching: Vec::new(),
            parallel: Vec::new(),
            condensed: element.modes() > 0,
        };
        for (index, group) in chosen.iter().enumerate() {
            let embedded = element.space() > element.dimension();
            let bent = group.is_content() && !element.has_corners_alone();
            if embedded && (bent || group.kind == SpringKind::Measure) {
                let problem =
                    "cannot be used on a surface or curve in space: its measure is known in the cell's plane only";
                return Err(Error::at(format!("springs.{}", group.name), problem).of_kind(ErrorKind::Unsupported));
            }
            if group.is_content() {
                springs.content = Some(group.kind);
                springs.groups.push(index);
                continue;
            }
            springs.groups.extend(group.nodes.iter().map(|_| index));
            if group.kind == SpringKind::Length {
                springs.pairs.extend(group.nodes.iter().map(|nodes| [nodes[0], nodes[1]]));
                continue;
            }
            let measure = group.measure.clone().map(|measure| Arc::new(Compiled::from(measure)));
            for nodes in &group.nodes {
                let (function, in_space) = match (&measure, springs.functions.last()) {
                    (Some(measure), _) => (measure.clone(), None),
                    (_, Some(last)) if last.kind == group.kind && last.nodes.len() == nodes.len() => {
                        (last.function.clone(), last.in_space.clone())
                    }
                    _ => {
                        let known = |d: usize| {
                            let known =
                                Measure::of_kind(group.kind, nodes.len(), d).map(|known| Arc::new(known.into()));
                            known.map_err(|e| e.at_key(format!("springs.{}", group.name)))
                        };
                        (known(springs.dimension)?, embedded.then(|| known(springs.space)).transpose()?)
                    }
                };
                let nodes = nodes.clone();
                springs.functions.push(FunctionSpring { kind: group.kind, nodes, function, in_space });
            }
        }
        springs.touching = sharing(&springs.pairs, 1);
        springs.parallel = sharing(&springs.pairs, 2);
        Ok(springs)
    }

    /// Springs between pairs of nodes of anything with so many nodes.
    pub fn between(pairs: Vec<[usize; 2]>, nodes: usize, dimension: usize) -> Springs {
        Springs {
            dimension,
            space: dimension,
            nodes,
            functions: Vec::new(),
            areas: Vec::new(),
            points: Vec::new(),
            content: None,
            groups: (0..pairs.len()).collect(),
            names: vec![String::new(); pairs.len()],
            touching: sharing(&pairs, 1),
            parallel: sharing(&pairs, 2),
            condensed: false,
            pairs,
        }
    }

    /// The length springs with these indices, then springs on functions and on the content, each with the name of its
    /// group.
    pub fn with(
        &self,
        lengths: &[usize],
        functions: Vec<(&str, FunctionSpring)>,
        content: Option<(&str, SpringKind)>,
    ) -> Springs {
        let mut springs = Springs {
            pairs: lengths.iter().map(|&s| self.pairs[s]).collect(),
            functions: Vec::new(),
            areas: Vec::new(),
            points: Vec::new(),
            content: content.map(|(_, kind)| kind),
            groups: Vec::new(),
            names: Vec::new(),
            touching: Vec::new(),
            parallel: Vec::new(),
            ..*self
        };
        let own = lengths.iter().map(|&s| self.names[self.groups[s]].as_str());
        let others = functions.iter().map(|(name, _)| *name).chain(content.iter().map(|(name, _)| *name));
        for name in own.chain(others) {
            let known = springs.names.iter().position(|n| n == name);
            springs.groups.push(known.unwrap_or(springs.names.len()));
            if known.is_none() {
                springs.names.push(name.to_string());
            }
        }
        springs.functions = functions.into_iter().map(|(_, function)| function).collect();
        springs.touching = sharing(&springs.pairs, 1);
        springs.parallel = sharing(&springs.pairs, 2);
        springs
    }

    /// The springs of an exact network: between all pairs of nodes; with `areas`, on the areas that pairs of tangents
    /// span at the quadrature points; and on the content at these points. A single point measures the content of the
    /// cell. With `whole`, one more spring measures the content of the cell.
    pub fn exact(element: &Element, areas: bool, whole: bool) -> Springs {
        let (table, dimension, nodes) = (&element.tabulation, element.dimension(), element.nodes());
        let kind = [None, Some(SpringKind::Area), Some(SpringKind::Volume)][dimension - 1];
        let pairs: Vec<[usize; 2]> = (0..nodes).flat_map(|a| (a + 1..nodes).map(move |b| [a, b])).collect();
        // The content at the only point of a rule is that of the whole cell, which is one spring.
        let is_single = table.points() == 1 && kind.is_some();
        let points = (0..table.points()).filter(|&q| !is_single && table.point_weight(q) != 0.0).collect::<Vec<_>>();
        let content = kind.filter(|_| is_single || whole);
        let areas = if areas { area_tables(table) } else { Vec::new() };
        let counts = [pairs.len(), areas.len(), points.len(), usize::from(content.is_some())];
        Springs {
            dimension,
            space: element.space(),
            nodes,
            functions: Vec::new(),
            content,
            groups: (0..4).flat_map(|group| std::iter::repeat_n(group, counts[group])).collect(),
            names: ["pairs", "areas", "points", "content"].map(String::from).to_vec(),
            touching: sharing(&pairs, 1),
            parallel: sharing(&pairs, 2),
            pairs,
            areas,
            points,
            condensed: element.modes() > 0,
        }
    }

    /// Whether a fit needs the matrix R and the gradients of the springs, because closed forms do not know a spring or the element.
    pub fn need_matrix(&self) -> bool {
        self.condensed || !self.functions.is_empty()
    }

    /// Whether spring s of an exact network measures content.
    pub fn is_on_content(&self, s: usize) -> bool {
        s >= self.pairs.len() + self.functions.len() + self.areas.len()
    }

    /// Nodes and measure of every spring of the element, in the cell's own plane or line.
    pub fn measures(&self, element: &Arc<Element>) -> Vec<(Vec<usize>, Measure)> {
        let every = || (0..self.nodes).collect();
        let lengths = self.pairs.iter().map(|pair| (pair.to_vec(), Measure::Length));
        let functions = self.functions.iter().map(|f| (f.nodes.clone(), Measure::Function(f.function.clone())));
        let areas = self.areas.iter().map(|table| (every(), Measure::Span(table.clone())));
        let points = self.points.iter().map(|&q| (every(), Measure::PointContent(element.clone(), q as u32)));
        let content = self.content.map(|_| (every(), Measure::Content(element.clone())));
        lengths.chain(functions).chain(areas).chain(points).chain(content).collect()
    }

    /// Checks that the springs belong to this element, or to one with as many nodes and dimensions and, like it, with or without condensed functions.
    ///
    /// # Errors
    /// They do not.
    pub fn check(&self, element: &Element) -> Result<()> {
        let expected = (element.nodes(), element.dimension(), element.space());
        if (self.nodes, self.dimension, self.space) != expected {
            let words =
                |(nodes, dimension, space)| format!("{nodes} nodes, {dimension} dimensions in space of {space}");
            let expected = format!("those of {}: {}", element.name, words(expected));
            return Err(Error::expected("springs", expected, words((self.nodes, self.dimension, self.space))));
        }
        if self.condensed != (element.modes() > 0) {
            let words = |condensed| if condensed { "with condensed functions" } else { "without condensed functions" };
            let expected = format!("those of {}: {}", element.name, words(!self.condensed));
            return Err(Error::expected("springs", expected, words(self.condensed)));
        }
        Ok(())
    }

    /// The dimension of the cell.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// The number of coordinates of a node; more than the dimension on surfaces and curves.
    pub fn space(&self) -> usize {
        self.space
    }

    /// The number of nodes of the cell.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// The node pairs of the length springs.
    pub fn pairs(&self) -> &[[usize; 2]] {
        &self.pairs
    }

    /// The springs on angles, areas, volumes, couplings and users' expressions.
    pub fn functions(&self) -> &[FunctionSpring] {
        &self.functions
    }

    /// What the area springs of exact networks measure: each is a table with a single point and two tangents.
    pub fn areas(&self) -> &[Arc<Tabulation>] {
        &self.areas
    }

    /// The quadrature points at which springs of exact networks measure the content.
    pub fn points(&self) -> &[usize] {
        &self.points
    }

    /// The kind of the last spring, if it measures the area or volume of the cell.
    pub fn content(&self) -> Option<SpringKind> {
        self.content
    }

    /// The group of each spring, as an index into [`names`](Springs::names).
    pub fn groups(&self) -> &[usize] {
        &self.groups
    }

    /// The names of the groups.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The pairs `(s, t)`, s < t, of length springs that share a node; the gradients of all other pairs are orthogonal.
    pub fn touching(&self) -> &[(usize, usize)] {
        &self.touching
    }

    /// The pairs `(s, t)`, s < t, of length springs that join the same two nodes.
    pub fn parallel(&self) -> &[(usize, usize)] {
        &self.parallel
    }

    /// Whether the element has condensed functions, so that its stiffness is no sum over products of the gradients of its nodes.
    pub fn is_condensed(&self) -> bool {
        self.condensed
    }

    /// The number of springs.
    pub fn len(&self) -> usize {
        self.groups.len()
    }

    /// Whether there are no springs.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// Writes the rows g_s, `[springs × nodes·dimension]`, of the element with nodes at `x`, `[nodes × dimension]`, m.
    ///
    /// The g of a length spring has no unit: −n at its first node and n at its second. That of the content is
    /// `∫ ∇N dV`, in m² (in two dimensions in m), so that its constant is in N/m⁵ (N/m³).
    ///
    /// # Panics
    /// If `x` or the geometry belongs to an element with fewer nodes.
    pub fn gradients(&self, x: &[f64], geometry: &Geometry, g: &mut Vec<f64>) {
        let d = self.dimension;
        let size = self.nodes * d;
        g.clear();
        g.resize(self.len() * size, 0.0);
        for (row, &[i, j]) in g.chunks_exact_mut(size).zip(&self.pairs) {
            let (xi, xj) = (&x[i * d..(i + 1) * d], &x[j * d..(j + 1) * d]);
            let length = distance(xi, xj);
            for k in 0..d {
                let n = (xj[k] - xi[k]) / length;
                row[i * d + k] = -n;
                row[j * d + k] = n;
            }
        }
        let first = self.pairs.len() * size;
        self.function_gradients(x, &mut g[first..]);
        let mut rows = g[first + self.functions.len() * size..].chunks_exact_mut(size);
        for (table, row) in self.areas.iter().zip(&mut rows) {
            row.copy_from_slice(&Content::of_point(table, 0, x).gradient());
        }
        rows.zip(&self.points).for_each(|(row, &q)| row.copy_from_slice(&geometry.point_content_gradient(q)));
        if self.content.is_some() {
            g[(self.len() - 1) * size..].copy_from_slice(&geometry.content_gradient());
        }
    }
}

/// The pairs of springs `(s, t)`, s < t, that have at least `nodes` nodes in common.
fn sharing(pairs: &[[usize; 2]], nodes: usize) -> Vec<(usize, usize)> {
    let common = |s: usize, t: usize| pairs[s].iter().filter(|node| pairs[t].contains(node)).count();
    (0..pairs.len()).flat_map(|t| (0..t).filter(move |&s| common(s, t) >= nodes).map(move |s| (s, t))).collect()
}
