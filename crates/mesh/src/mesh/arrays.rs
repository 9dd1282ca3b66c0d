//! Meshes from the arrays of another program.

use super::mesh::{CellBlock, CellIndex, Group, Mesh, sorted};
use super::numbering::{NumberOrigin, Numbering};
use super::quality::Gate;
use super::resolution::check_size;
use crate::element::Element;
use crate::error::{Error, Result};
use crate::number::first_not_finite;
use crate::stiffness::each_cell;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Points, cells and named points, as another program has them.
#[derive(Debug, Clone)]
pub struct MeshArrays {
    /// The space has this dimension: 1, 2 or 3.
    pub dimension: usize,
    /// `[points × dimension]`, m.
    pub points: Vec<f64>,
    /// Elements of one dimension, each with the nodes of its cells: `[cells × nodes]`, indices into `points` from 0, in the order of the
    /// element's nodes.
    pub blocks: Vec<(Arc<Element>, Vec<usize>)>,
    /// Indices into `points`. A group has the sides on the boundary and the cells all of whose nodes it has.
    pub groups: BTreeMap<String, Vec<usize>>,
    /// Indices of cells, counted over all blocks in their order. A group that has no points of its own has those of its cells; one that is in
    /// `groups` as well has these cells in place of those whose nodes it has.
    pub cell_groups: BTreeMap<String, Vec<usize>>,
}

impl MeshArrays {
    /// The mesh, whose cells are proved as those of a file are. Its numbering has the indices of its points in the arrays.
    ///
    /// # Errors
    /// A length, a place or a coordinate is wrong, the elements do not go together; a cell is tangled or flat, repeats another or is
    /// folded over its neighbours, unless the gate skips such cells; the gate refuses a cell, or none is left.
    pub fn build(self, gate: Gate) -> Result<Mesh> {
        let count = self.check()?;
        let MeshArrays { dimension, points, blocks, groups, cell_groups } = self;
        let mut mesh = Mesh::of_points(dimension, points);
        mesh.numbering = Some(Numbering { origin: NumberOrigin::ArrayPlace, nodes: (0..count as u64).collect() });
        for (mut element, connectivity) in blocks {
            if element.dimension() < dimension {
                element = Arc::new(Element::clone(&element).in_space(dimension));
            }
            mesh.blocks.push(CellBlock { element, connectivity });
        }
        let boundary = if groups.is_empty() { Vec::new() } else { mesh.boundary() };
        mesh.groups = groups.into_iter().map(|(name, points)| (name, mesh.group_of(&points, &boundary))).collect();
        let indices: Vec<CellIndex> = if cell_groups.is_empty() { Vec::new() } else { mesh.cell_indices().collect() };
        for (name, mut listed) in cell_groups {
            // A caller may list cells in any order, and twice.
            listed.sort_unstable();
            listed.dedup();
            let cells: Vec<CellIndex> = listed.into_iter().map(|cell| indices[cell]).collect();
            let mut points: Vec<usize> = cells.iter().flat_map(|cell| mesh.cell_nodes(*cell)).copied().collect();
            // Neighbours share points. Groups have ascending lists, in which points are searched by halving.
            points.sort_unstable();
            points.dedup();
            let group = mesh.groups.entry(name).or_insert_with(|| Group { points, ..Group::default() });
            group.cells = cells;
        }
        mesh.settle(gate)?;
        Ok(mesh)
    }

    /// The number of points.
    fn check(&self) -> Result<usize> {
        let d = self.dimension;
        if !(1..=3).contains(&d) {
            return Err(Error::expected("dimension", "1, 2 or 3", d));
        }
        if self.points.is_empty() || !self.points.len().is_multiple_of(d) {
            return Err(Error::expected("points", format!("points of {d} coordinates"), self.points.len()));
        }
        if let Some(place) = first_not_finite(&self.points) {
            let key = format!("points[{}]", place / d);
            return Err(Error::expected(key, "finite coordinates", format!("{:?}", self.points[place])));
        }
        check_size(self.points.iter().copied())?;
        let count = self.points.len() / d;
        let outside = |list: &[usize]| list.iter().copied().find(|&p| p >= count);
        let expected = || format!("indices of the {count} points, from 0");
        let cells = self.blocks.first().map(|(element, _)| element.dimension());
        let cells = cells.ok_or_else(|| Error::expected("cells", "cells of an element", "none"))?;
        for (element, connectivity) in &self.blocks {
            let (key, n) = (format!("cells of {}", element.name), element.nodes());
            if element.dimension() != cells || cells > d {
                let expected = format!("elements of one dimension, at most that of the points, {d}");
                return Err(Error::expected(key, expected, format!("one of dimension {}", element.dimension())));
            }
            if connectivity.is_empty() || !connectivity.len().is_multiple_of(n) {
                let found = match connectivity.len() {
                    0 => "none".into(),
                    count => format!("{count} nodes in all"),
                };
                return Err(Error::expected(key, format!("one or more cells of {n} nodes"), found));
            }
            if let Some(found) = outside(connectivity) {
                // Other programs count from 1.
                let from_one = found == count && !self.blocks.iter().any(|(_, nodes)| nodes.contains(&0));
                let hint = if from_one { "; all are from 1 to that: are they numbered from 1?" } else { "" };
                return Err(Error::expected(key, expected(), format!("{found}{hint}")));
            }
        }
        let total: usize = self.blocks.iter().map(|(element, nodes)| nodes.len() / element.nodes()).sum();
        for (name, cells) in &self.cell_groups {
            if let Some(found) = cells.iter().find(|&&cell| cell >= total) {
                let expected = format!("places of the {total} cells, from 0");
                return Err(Error::expected(format!("cell_groups.{name}"), expected, found));
            }
        }
        for (name, points) in &self.groups {
            if let Some(found) = outside(points) {
                return Err(Error::expected(format!("groups.{name}"), expected(), found));
            }
        }
        Ok(count)
    }
}

impl Mesh {
    /// Some cells of a mesh that is proved as a whole elsewhere, without groups; every point belongs to a cell. Blocks are as those of
    /// [`MeshArrays`].
    ///
    /// # Errors
    /// A length or a place is wrong, or a cell has no volume.
    pub fn of_proved_cells(
        dimension: usize,
        points: Vec<f64>,
        blocks: Vec<(Arc<Element>, Vec<usize>)>,
    ) -> Result<Mesh> {
        let (groups, cell_groups) = Default::default();
        let arrays = MeshArrays { dimension, points, blocks, groups, cell_groups };
        arrays.check()?;
        let mut mesh = Mesh::of_points(dimension, arrays.points);
        for (element, connectivity) in arrays.blocks {
            each_cell(&element.tabulation, &mesh.points, &connectivity, |_, _, _| ()).map_err(|(cell, fault)| {
                let key = format!("{} cell {}", element.name, cell + 1);
                Error::expected(key, "a cell with a volume", fault)
            })?;
            mesh.blocks.push(CellBlock { element, connectivity });
        }
        Ok(mesh)
    }

    /// The points of each side that belongs to one cell alone.
    fn boundary(&self) -> Vec<Vec<usize>> {
        let mut boundary = Vec::new();
        self.each_side_set(|sides| {
            if let [index] = sides {
                boundary.push(sorted(&self.side_nodes(index)));
            }
        });
        boundary
    }

    /// The group of these points, and of the sides on the boundary and the cells that have no others.
    fn group_of(&self, points: &[usize], boundary: &[Vec<usize>]) -> Group {
        let mut is_in = vec![false; self.point_count()];
        points.iter().for_each(|&p| is_in[p] = true);
        let has = |nodes: &[usize]| nodes.iter().all(|&p| is_in[p]);
        Group {
            points: (0..is_in.len()).filter(|&p| is_in[p]).collect(),
            lists_points: true,
            sides: boundary.iter().filter(|side| has(side)).cloned().collect(),
            edges: Vec::new(),
            cells: self.cell_indices().filter(|cell| has(self.cell_nodes(*cell))).collect(),
        }
    }
}
