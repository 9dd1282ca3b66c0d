//! The division of one element into smaller ones.

use super::children::Child;
use crate::element::{Cell, Element, same_place};
use crate::error::{Error, ErrorKind, Result};
use std::collections::HashMap;

/// Shape functions below this at a point are zero there.
// Values of functions of size one are known to some thousand roundings. Those that do not vanish at nodes of a divided cell are
// fractions with small denominators.
const ZERO: f64 = 1e-12;

/// The division of an element: its points, its cells, and the parts of its sides and edges.
pub struct Pattern {
    /// For each point, the nodes whose shape functions are not zero there, with their values; the nodes themselves come
    /// first.
    pub points: Vec<Vec<(usize, f64)>>,
    /// The kind of each cell, and its nodes as points of the pattern.
    pub cells: Vec<(Cell, Vec<usize>)>,
    /// The parts of each side of the element.
    pub sides: Vec<Vec<Vec<usize>>>,
    /// The nodes of each edge of a solid element, and its parts.
    pub edges: Vec<(Vec<usize>, Vec<Vec<usize>>)>,
}

impl Pattern {
    /// The division of an element into these parts; `element_of` gives the element of each kind of cell in it.
    ///
    /// # Errors
    /// There are no parts, or the element shares no points with its neighbours: shape functions
    /// of nodes that are not on a side do not vanish there.
    pub fn of<'a>(
        element: &'a Element,
        parts: Vec<Child>,
        element_of: &dyn Fn(Cell) -> Result<&'a Element>,
    ) -> Result<Pattern> {
        let d = element.dimension();
        if parts.is_empty() {
            let expected = "cells that can be divided into cells of their own kind";
            return Err(Error::expected("mesh", expected, &element.name).of_kind(ErrorKind::Unsupported));
        }
        let mut places: Vec<Vec<f64>> = element.positions.chunks_exact(d).map(<[f64]>::to_vec).collect();
        let mut cells: Vec<(&Element, Vec<usize>)> = Vec::new();
        for part in parts {
            let own = element_of(part.cell)?;
            let at = |at: &[f64]| point_at(&mut places, part.map.place(at));
            cells.push((own, own.positions.chunks_exact(d).map(at).collect()));
        }
        let points = places.iter().enumerate().map(|(i, at)| support(element, i, at)).collect::<Option<Vec<_>>>();
        let points = points.ok_or_else(|| apart(element))?;
        let sides = sides(element, &points, &cells)?;
        let edges = if d == 3 { edges(element, &points, &cells) } else { Vec::new() };
        let cells = cells.into_iter().map(|(own, nodes)| (own.cell, nodes)).collect();
        Ok(Pattern { points, cells, sides, edges })
    }
}

/// The index of the position among the known ones, to which it is added if it is new.
fn point_at(places: &mut Vec<Vec<f64>>, at: Vec<f64>) -> usize {
    places.iter().position(|known| same_place(known, &at)).unwrap_or_else(|| {
        places.push(at);
        places.len() - 1
    })
}

/// The shape functions that are not zero at a point; `None` if one is not finite.
fn support(element: &Element, point: usize, at: &[f64]) -> Option<Vec<(usize, f64)>> {
    if point < element.nodes() {
        return Some(vec![(point, 1.0)]);
    }
    let values = element.functions.values.iter().map(|n| n.evaluate(at)).enumerate();
    // The comparison is negated so that a value that is not a number is kept, and refused below.
    let kept: Vec<(usize, f64)> = values.filter(|(_, n)| !(n.abs() < ZERO)).collect();
    kept.iter().all(|(_, n)| n.is_finite()).then_some(kept)
}

fn apart(element: &Element) -> Error {
    let expected = "elements with shape functions that vanish on the sides that do not have their nodes";
    Error::expected("mesh", expected, &element.name).of_kind(ErrorKind::Unsupported)
}

/// The outer sides of the cells, listed under the side of the element whose shape functions alone are not zero there.
fn sides(
    element: &Element,
    points: &[Vec<(usize, f64)>],
    cells: &[(&Element, Vec<usize>)],
) -> Result<Vec<Vec<Vec<usize>>>> {
    let mut met: HashMap<Vec<usize>, usize> = HashMap::new();
    let mut order = Vec::new();
    for (own, nodes) in cells {
        for side in own.sides() {
            let side = points_of(&side.nodes, nodes);
            *met.entry(side.clone()).or_insert_with(|| {
                order.push(side);
                0
            }) += 1;
        }
    }
    let mut parts = vec![Vec::new(); element.sides().len()];
    // A side of two parts is inside the cell; one that was met once is part of a side of the cell.
    for side in order.into_iter().filter(|side| met[side] == 1) {
        // A point is on the side where the nodes of the side alone have a share in it.
        let holds = |nodes: &[usize]| side.iter().all(|&p| points[p].iter().all(|(a, _)| nodes.contains(a)));
        let place = element.sides().iter().position(|own| holds(&own.nodes)).ok_or_else(|| apart(element))?;
        parts[place].push(side);
    }
    Ok(parts)
}

/// The edges of the cells that are on edges of the element.
fn edges(
    element: &Element,
    points: &[Vec<(usize, f64)>],
    cells: &[(&Element, Vec<usize>)],
) -> Vec<(Vec<usize>, Vec<Vec<usize>>)> {
    let mut all: Vec<Vec<usize>> = Vec::new();
    for (own, nodes) in cells {
        all.extend(edge_nodes(own).iter().map(|edge| points_of(edge, nodes)));
    }
    // Children share edges.
    all.sort_unstable();
    all.dedup();
    let parts_of = |own: Vec<usize>| {
        let holds = |edge: &&Vec<usize>| edge.iter().all(|&p| points[p].iter().all(|(a, _)| own.contains(a)));
        let parts = all.iter().filter(holds).cloned().collect();
        (own, parts)
    };
    edge_nodes(element).into_iter().map(parts_of).collect()
}

/// The nodes of each edge of a solid element: those on both of the sides that meet there.
fn edge_nodes(element: &Element) -> Vec<Vec<usize>> {
    let nodes_of = |[a, b]: [usize; 2]| {
        let meets = |(side, _): &(&crate::element::Side, _)| side.corners.contains(&a) && side.corners.contains(&b);
        let both: Vec<&Vec<usize>> =
            element.cell.sides().iter().zip(element.sides()).filter(meets).map(|(_, table)| &table.nodes).collect();
        let common = |node: &&usize| both.iter().all(|nodes| nodes.contains(node));
        both.first().map_or(Vec::new(), |nodes| nodes.iter().filter(common).copied().collect())
    };
    element.cell.edges().into_iter().map(nodes_of).collect()
}

/// Points of the pattern at nodes of a cell, ascending.
fn points_of(places: &[usize], nodes: &[usize]) -> Vec<usize> {
    let mut points: Vec<usize> = places.iter().map(|&a| nodes[a]).collect();
    points.sort_unstable();
    points
}
