//! Groups of springs, made from the entries of an element file.

use super::cell::Cell;
use super::definition::{Definition, NodeLists, SpringEntry};
use super::formula::coordinate_names;
use super::invariance::expect_invariant;
use super::kind::{Kind, SpringKind, Symmetry};
use super::symmetry::permutations;
use crate::error::{Error, Result};
use crate::symbolic::{Expr, Scope};
use serde::{Serialize, Serializer};
use std::collections::{BTreeMap, HashSet};

/// Springs that the symmetry of the cell maps onto each other, and that a fit may tie to one constant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpringGroup {
    /// The name of the group in files and options.
    pub name: String,
    /// The name in the element file, which the classes of one entry share.
    #[serde(skip)]
    pub entry: String,
    /// What its springs measure.
    pub kind: SpringKind,
    /// The nodes of each spring, `[springs][nodes of a spring]`; empty if the whole cell is measured. JSON has their number.
    #[serde(rename = "springs", serialize_with = "count")]
    pub nodes: Vec<Vec<usize>>,
    /// For the kind `measure`: what is measured, as a function of the coordinates of the nodes of one spring.
    #[serde(skip)]
    pub measure: Option<Expr>,
    /// Whether the group is used only by fits that name it.
    pub optional: bool,
}

impl SpringGroup {
    /// Whether the group is the one spring on the area or volume of the whole cell.
    pub fn is_content(&self) -> bool {
        self.nodes.is_empty()
    }
}

/// Writes how many springs a cell has; one where the whole cell is measured.
fn count<S: Serializer>(nodes: &[Vec<usize>], to: S) -> std::result::Result<S::Ok, S::Error> {
    nodes.len().max(1).serialize(to)
}

/// The groups of a file, with node positions `[nodes × dimension]`.
///
/// # Errors
/// An entry is wrong; the error names it.
pub fn spring_groups(definition: &Definition, positions: &[f64]) -> Result<Vec<SpringGroup>> {
    let mut groups: Vec<SpringGroup> = Vec::new();
    // What is measured by a spring already.
    let mut taken = HashSet::new();
    for (i, entry) in definition.springs.iter().enumerate() {
        let key = |rest: &str| format!("springs[{i}].{rest}");
        let nodes = nodes_of(i, entry, definition, positions, &taken)?;
        for (p, list) in nodes.iter().enumerate() {
            if !taken.insert(identity(entry, list)) {
                let what = if entry.kind == SpringKind::Length { "pair" } else { "list" };
                let problem = format!("the {what} {list:?} has a spring already");
                return Err(Error::at(key(&format!("nodes[{p}]")), problem));
            }
        }
        // Two springs on one content would be linearly dependent in every fit.
        if nodes.is_empty() && groups.iter().any(SpringGroup::is_content) {
            return Err(Error::at(key("kind"), "the cell's content has a spring already"));
        }
        let measure = measure_of(i, entry, definition, &nodes, positions)?;
        let classes = match entry.class {
            Some(_) => classes(entry, &nodes, &permutations(definition.cell, positions)),
            None => vec![nodes],
        };
        let several = classes.len() > 1;
        for (number, nodes) in classes.into_iter().enumerate() {
            let name = if several { format!("{} {}", entry.group, number + 1) } else { entry.group.clone() };
            if groups.iter().any(|g| g.name == name) {
                return Err(Error::expected(key("group"), "a name used once", format!("\"{name}\" again")));
            }
            let measure = measure.clone();
            let entry_name = entry.group.clone();
            groups.push(SpringGroup {
                name,
                entry: entry_name,
                kind: entry.kind,
                nodes,
                measure,
                optional: entry.optional,
            });
        }
    }
    Ok(groups)
}

/// The node lists of an entry; none for the whole cell.
fn nodes_of(
    i: usize,
    entry: &SpringEntry,
    definition: &Definition,
    positions: &[f64],
    taken: &HashSet<(SpringKind, String, Vec<usize>)>,
) -> Result<Vec<Vec<usize>>> {
    let key = |rest: &str| format!("springs[{i}].{rest}");
    let (count, d) = (definition.nodes.len(), definition.cell.dimension());
    let lists = match (&entry.nodes, entry.kind) {
        (Some(NodeLists::Named(name)), SpringKind::Length | SpringKind::Angle) if name == "complete" => {
            let (all, what) = match entry.kind {
                SpringKind::Angle => (corner_angles(definition.cell, positions), "angles at the corners"),
                _ => (pairs(count), "pairs"),
            };
            // The word fills up what other entries leave, so that groups may name their own springs first.
            let free: Vec<Vec<usize>> =
                all.into_iter().filter(|list| !taken.contains(&identity(entry, list))).collect();
            if free.is_empty() {
                return Err(Error::expected(key("nodes"), format!("{what} that have no spring yet"), "none"));
            }
            return Ok(free);
        }
        (Some(NodeLists::Named(name)), _) => {
            let expected = "lists of nodes, or \"complete\" with the kind \"length\" or \"angle\"";
            return Err(Error::expected(key("nodes"), expected, format!("\"{name}\"")));
        }
        (Some(NodeLists::Given(lists)), _) => lists,
        (None, kind) if kind.properties().content == Some(d) => return Ok(Vec::new()),
        (None, kind) => {
            let properties = kind.properties();
            let (key, expected) = match properties.content {
                Some(2) => ("kind", "\"volume\" for the content of a solid, \"area\" with nodes or in a plane cell"),
                Some(_) => ("kind", "\"area\" for the content of a plane cell, \"volume\" in a solid"),
                None if *properties.nodes.end() == 2 => ("nodes", "pairs of nodes"),
                None => ("nodes", "lists of nodes"),
            };
            let found = if properties.content.is_some() { format!("\"{}\"", kind.name()) } else { "none".into() };
            return Err(Error::expected(format!("springs[{i}].{key}"), expected, found));
        }
    };
    if lists.is_empty() {
        return Err(Error::expected(key("nodes"), "lists of nodes", "none"));
    }
    let Kind { nodes: range, least_dimension, symmetry, .. } = entry.kind.properties();
    if d < least_dimension {
        let expected = format!("a cell of at least {least_dimension} dimensions");
        return Err(Error::expected(key("kind"), expected, format!("\"{}\" in {d}", entry.kind.name())));
    }
    for (p, list) in lists.iter().enumerate() {
        let key = key(&format!("nodes[{p}]"));
        if !range.contains(&list.len()) {
            let words = ["no", "one", "two", "three", "four", "five", "six", "seven", "eight"];
            let (least, most) = (words[*range.start()], words[*range.end()]);
            let expected = if least == most { format!("{least} nodes") } else { format!("{least} to {most} nodes") };
            return Err(Error::expected(key, expected, list.len()));
        }
        if list.iter().any(|a| *a >= count) || !symmetry.are_different(list) {
            let what = match symmetry {
                Symmetry::Pairs => "two different pairs of different",
                Symmetry::Any if *range.end() == 2 => "two different",
                Symmetry::Any | Symmetry::Ends | Symmetry::Ordered => "different",
            };
            return Err(Error::expected(key, format!("{what} nodes below {count}"), format!("{list:?}")));
        }
    }
    Ok(lists.clone())
}

/// All pairs of nodes.
fn pairs(count: usize) -> Vec<Vec<usize>> {
    (0..count).flat_map(|a| (a + 1..count).map(move |b| vec![a, b])).collect()
}

/// The angles between two edges that meet at a corner, for all such edges: the nodes at their other ends, and that of the corner between
/// them. Corners without a node have none.
fn corner_angles(cell: Cell, positions: &[f64]) -> Vec<Vec<usize>> {
    let edges: Vec<[usize; 2]> = cell
        .edges()
        .into_iter()
        .filter_map(|[a, b]| Some([cell.corner_node(a, positions)?, cell.corner_node(b, positions)?]))
        .collect();
    let mut angles = Vec::new();
    for (i, &[a, b]) in edges.iter().enumerate() {
        for &[c, d] in &edges[..i] {
            let met = [[a, b, c, d], [b, a, c, d], [a, b, d, c], [b, a, d, c]];
            // Two edges share one corner at most: one of the four ways fits, or none.
            angles.extend(met.iter().find(|[_, b, c, _]| b == c).map(|[a, b, _, d]| vec![*a, *b, *d]));
        }
    }
    angles
}

/// The measure of the file, which must not change under rigid motions; an error if another kind has a measure.
fn measure_of(
    i: usize,
    entry: &SpringEntry,
    definition: &Definition,
    nodes: &[Vec<usize>],
    positions: &[f64],
) -> Result<Option<Expr>> {
    let key = format!("springs[{i}].measure");
    match (&entry.measure, entry.kind) {
        (None, SpringKind::Measure) => Err(Error::expected(key, "an expression of x0, y0, x1, …", "none")),
        (None, _) => Ok(None),
        (Some(text), SpringKind::Measure) => {
            let count = nodes[0].len();
            if let Some(p) = nodes.iter().position(|list| list.len() != count) {
                let expected = format!("{count} nodes as in the first list");
                return Err(Error::expected(format!("springs[{i}].nodes[{p}]"), expected, nodes[p].len()));
            }
            let d = definition.cell.dimension();
            let scope = Scope::new(&coordinate_names(count, d));
            let measure = scope.expression(text).map_err(|e| e.under(&key))?;
            let places: Vec<f64> = nodes[0].iter().flat_map(|a| positions[a * d..(a + 1) * d].to_vec()).collect();
            expect_invariant(&measure, &places, d).map_err(|e| e.under(&key))?;
            Ok(Some(measure))
        }
        (Some(_), kind) => {
            Err(Error::at(key, format!("belongs to the kind \"measure\", found with \"{}\"", kind.name())))
        }
    }
}

/// The key that is equal for two springs that measure the same.
fn identity(entry: &SpringEntry, nodes: &[usize]) -> (SpringKind, String, Vec<usize>) {
    let nodes = entry.kind.properties().symmetry.representative(nodes);
    (entry.kind, entry.measure.clone().unwrap_or_default(), nodes)
}

/// The orbits of the springs under the permutations of the nodes, in the order of their first springs.
fn classes(entry: &SpringEntry, nodes: &[Vec<usize>], permutations: &[Vec<usize>]) -> Vec<Vec<Vec<usize>>> {
    let place: BTreeMap<_, usize> = nodes.iter().enumerate().map(|(p, list)| (identity(entry, list), p)).collect();
    let mut class = vec![usize::MAX; nodes.len()];
    let mut classes: Vec<Vec<Vec<usize>>> = Vec::new();
    for first in 0..nodes.len() {
        if class[first] != usize::MAX {
            continue;
        }
        for permutation in permutations {
            let image: Vec<usize> = nodes[first].iter().map(|&a| permutation[a]).collect();
            if let Some(&p) = place.get(&identity(entry, &image)) {
                class[p] = classes.len();
            }
        }
        let members = (0..nodes.len()).filter(|&p| class[p] == classes.len()).map(|p| nodes[p].clone());
        classes.push(members.collect());
    }
    classes
}
