//! Membranes and rods on the sides of a body.

use super::mesh::{CellBlock, CellIndex, Mesh, SideIndex};
use super::selection::ListedSides;
use crate::element::{Cell, Element, SHIPPED, Side, same_place};
use crate::error::{Error, ErrorKind, Result};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

impl Mesh {
    /// Makes the sides of these groups cells of the body, where a group lists sides of cells and no cells: membranes on a solid, rods on a plane body.
    /// They have the shipped elements with the functions of the sides.
    ///
    /// # Errors
    /// No shipped element has the functions of a side (kind `Unsupported`).
    pub fn attach_sides(&mut self, names: &[String]) -> Result<()> {
        let mut known_sides: HashMap<(usize, usize), (Arc<Element>, Vec<usize>)> = HashMap::new();
        for name in names {
            let Some(group) = self.groups.get(name).filter(|group| group.cells.is_empty()) else { continue };
            let sides = ListedSides::of(self, group).sides;
            // Sides of lines are points, on which no cell can lie.
            if sides.is_empty() || self.cell_dimension() < 2 {
                continue;
            }
            let mut cells = Vec::with_capacity(sides.len());
            for side in &sides {
                // To read elements takes longer than all else here.
                let (element, places) = match known_sides.entry((side.cell.block, side.side)) {
                    Entry::Occupied(known) => known.into_mut(),
                    Entry::Vacant(place) => place.insert(self.of_side(side)?),
                };
                let points = self.cell_nodes(side.cell);
                let nodes: Vec<usize> = places.iter().map(|&node| points[node]).collect();
                let known = self.blocks.iter().position(|block| block.element.name == element.name);
                let block = known.unwrap_or_else(|| {
                    let element = Arc::new(Element::clone(element).in_space(self.dimension));
                    self.blocks.push(CellBlock { element, connectivity: Vec::new() });
                    self.blocks.len() - 1
                });
                cells.push(CellIndex { block, cell: self.blocks[block].cells().len() });
                self.blocks[block].connectivity.extend(nodes);
            }
            let what = if self.cell_dimension() == 3 { "membranes" } else { "rods" };
            self.annotations.remark(attached_words(name, what));
            if let Some(group) = self.groups.get_mut(name) {
                group.cells = cells;
            }
        }
        Ok(())
    }

    /// The element of a side, and the nodes of the cell that are its own, in their order.
    pub(super) fn of_side(&self, side: &SideIndex) -> Result<(Arc<Element>, Vec<usize>)> {
        let body = &self.blocks[side.cell.block].element;
        let own = &body.cell.sides()[side.side];
        let count = body.sides()[side.side].nodes.len();
        let shipped = SHIPPED.iter().filter_map(|file| Element::shipped(file).ok());
        let mut fitting = shipped.filter(|element| element.cell == own.cell && element.nodes() == count);
        let placed = fitting.find_map(|element| {
            let nodes = on_side(&element, own, body)?;
            Some((Arc::new(element), nodes))
        });
        placed.ok_or_else(|| {
            let expected = "cells with sides of a shipped element, for cells on them";
            Error::expected("material", expected, &body.name).of_kind(ErrorKind::Unsupported)
        })
    }
}

/// The nodes of a body's element that are where an element on one of its sides has its own, in the order of these; `None` if one is missing.
fn on_side(element: &Element, side: &Side, body: &Element) -> Option<Vec<usize>> {
    let parent: Cell = body.cell;
    let (origin, tangents) = side.embedding(parent);
    let d = parent.dimension();
    let node = |s: &[f64]| {
        let at: Vec<f64> =
            (0..d).map(|k| origin[k] + s.iter().zip(&tangents).map(|(s, t)| s * t[k]).sum::<f64>()).collect();
        body.positions.chunks_exact(d).position(|x| same_place(x, &at))
    };
    element.positions.chunks_exact(d - 1).map(node).collect()
}

/// That the cells of a group are part of the body.
pub(super) fn attached_words(name: &str, what: &str) -> String {
    format!("the group \"{name}\" is part of the body as {what}, without bending stiffness")
}
