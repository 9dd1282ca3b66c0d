//! Gives the cells of a file their elements.

use super::attached::attached_words;
use super::mesh::{CellBlock, CellIndex, Mesh, sorted};
use super::numbering::Numbering;
use super::order::SourceOrder;
use super::places::Places;
use super::quality::{Below, Gate};
use super::selection::ListedSides;
use super::source::{Format, MeshSource, SourceBlock};
use crate::element::{Element, FormatEntry, SHIPPED};
use crate::error::{Error, ErrorKind, Result};
use crate::range;
use crate::stiffness::{Fault, Geometry, Placement};
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

impl Mesh {
    /// Gives each cell of a file its element: one of `own` if it serves the cell type, otherwise a shipped one.
    /// Coordinates are multiplied by `scale`, in metres per mesh unit. Cells of poor quality, points at the same
    /// position, points on a side of a cell that does not have them, and pieces that share no node are counted.
    ///
    /// # Errors
    /// No element serves a cell type; or a cell is tangled or flat, repeats another or is folded over its neighbours.
    pub fn resolve(source: &MeshSource, own: &[Arc<Element>], scale: f64) -> Result<Mesh> {
        Mesh::resolve_within(source, own, scale, None)
    }

    /// Gives each cell of a file its element as [`Mesh::resolve`] does, with a given gate for the cells.
    ///
    /// # Errors
    /// Those of [`Mesh::resolve`], unless the gate skips such cells; or the gate refuses a cell, or no cell is left.
    pub fn resolve_within(source: &MeshSource, own: &[Arc<Element>], scale: f64, gate: Option<Gate>) -> Result<Mesh> {
        Mesh::resolve_attached(source, own, scale, gate, &[])
    }

    /// Gives each cell of a file its element as [`Mesh::resolve_within`] does, also those of fewer dimensions than the body in the groups `attached`,
    /// which become part of it: membranes on solids, rods in them. A group that has cells of the body stands for these alone.
    ///
    /// # Errors
    /// It fails as [`Mesh::resolve_within`] does.
    pub fn resolve_attached(
        source: &MeshSource,
        own: &[Arc<Element>],
        scale: f64,
        gate: Option<Gate>,
        attached: &[String],
    ) -> Result<Mesh> {
        let dimension = source.blocks.iter().map(|b| b.dimension).max().unwrap_or(0);
        if dimension == 0 {
            let error = Error::expected("cells", "lines, surface or solid cells", "none");
            return Err(match source.annotations.left_out.is_empty() {
                true => error,
                false => error.followed_by(format!(" but {}", source.annotations.left_out_words())),
            });
        }
        let of_surface = if dimension == 2 && source.space == Some(3) { source.without_idle_faces() } else { None };
        let source = of_surface.as_ref().unwrap_or(source);
        let is_flat = dimension < 3 && in_one_plane(source);
        let space = match source.space {
            None if is_flat => 2,
            Some(2) if is_flat => 2,
            Some(2) => {
                return Err(Error::expected("space", "points with one z, for the space has 2 dimensions", "others"));
            }
            _ => 3,
        };
        check_names(source)?;
        check_size(source.points.iter().flatten().map(|x| x * scale))?;
        let points = source.points.iter().flat_map(|p| p[..space].iter().map(|x| x * scale)).collect();
        let annotations = source.annotations.clone();
        let mut mesh = Mesh { numbering: numbering(source), annotations, ..Mesh::of_points(space, points) };
        let (mut served, mut order) = (BTreeMap::<u32, usize>::new(), SourceOrder::default());
        let is_of_body = |name: &String| {
            source.blocks.iter().any(|block| block.dimension == dimension && block.groups.contains(name))
        };
        let attached: Vec<&String> = attached.iter().filter(|name| !is_of_body(name)).collect();
        let is_attached = |block: &SourceBlock| {
            (1..dimension).contains(&block.dimension) && block.groups.iter().any(|name| attached.contains(&name))
        };
        let mut part: Vec<&SourceBlock> =
            source.blocks.iter().filter(|block| block.dimension == dimension || is_attached(block)).collect();
        // The body comes first: it has the cells of the most dimensions.
        part.sort_by_key(|block| std::cmp::Reverse(block.dimension));
        for block in part {
            let index = match served.get(&block.cell_type) {
                Some(&index) => index,
                None => {
                    let mut element = element_for(source.format, block, own)?;
                    if element.dimension() < space {
                        element = Arc::new(Element::clone(&element).in_space(space));
                    }
                    mesh.blocks.push(CellBlock { element, connectivity: Vec::new() });
                    served.insert(block.cell_type, mesh.blocks.len() - 1);
                    mesh.blocks.len() - 1
                }
            };
            order.add(index, mesh.blocks[index].cells().len(), block);
            mesh.add_cells(index, block, source.format);
        }
        order.restore(&mut mesh);
        let mut is_of_cell = vec![false; source.points.len()];
        mesh.blocks.iter().flat_map(|block| &block.connectivity).for_each(|&p| is_of_cell[p] = true);
        // A name stands for its points of the lowest dimension that are of the body.
        let mut listed: BTreeMap<&String, BTreeMap<usize, Vec<usize>>> = BTreeMap::new();
        for block in &source.blocks {
            for name in &block.groups {
                let points = listed.entry(name).or_default().entry(block.dimension).or_default();
                points.extend(block.connectivity.iter().filter(|&&p| is_of_cell[p]));
            }
        }
        for (name, parts) in listed {
            let group = mesh.groups.entry(name.clone()).or_default();
            if let Some((dimension, points)) = parts.into_iter().find(|(_, points)| !points.is_empty()) {
                (group.points, group.lists_points) = (points, dimension == 0);
            }
        }
        for block in source.blocks.iter().filter(|b| b.dimension < dimension && b.nodes_per_cell > 0) {
            let is_attached = is_attached(block);
            let cells = block.connectivity.chunks_exact(block.nodes_per_cell);
            let is_left_out = |nodes: &&[usize]| !(block.is_marker && nodes.iter().all(|&p| is_of_cell[p]));
            let left_out = match block.is_marker && (block.groups.is_empty() || block.is_of_polygons()) {
                _ if is_attached => 0,
                true => cells.len(),
                false => cells.filter(is_left_out).count(),
            };
            mesh.annotations.leave_out(&block.title(), left_out);
            for name in &block.groups {
                let group = mesh.groups.entry(name.clone()).or_default();
                let parts = block.connectivity.chunks_exact(block.nodes_per_cell).map(sorted);
                match (block.dimension, dimension - block.dimension) {
                    // The ends of lines are points, and loads act on them as such.
                    (0, _) => {}
                    (_, 1) => group.sides.extend(parts),
                    (1, _) => group.edges.extend(parts),
                    _ => {}
                }
            }
        }
        mesh.settle(gate.unwrap_or_default())?;
        // Attached cells are sides of the body where they lie on it.
        for &name in &attached {
            let of_name = source.blocks.iter().filter(|block| is_attached(block) && block.groups.contains(name));
            if let Some(most) = of_name.map(|block| block.dimension).max() {
                let what = if most == 2 { "membranes" } else { "rods" };
                mesh.annotations.remark(attached_words(name, what));
            }
            let Some(group) = mesh.groups.get(name) else { continue };
            let lost: HashSet<Vec<usize>> = ListedSides::of(&mesh, group).lost.into_iter().collect();
            if let Some(group) = mesh.groups.get_mut(name).filter(|_| !lost.is_empty()) {
                group.sides.retain(|side| !lost.contains(side));
            }
        }
        Ok(mesh)
    }

    /// Proves the cells as they were given, leaves out what belongs to none, and measures the quality of what is kept.
    ///
    /// # Errors
    /// A cell is tangled or flat, repeats another or is folded over its neighbours, unless the gate skips such cells; the gate
    /// refuses a cell, or none is left.
    pub(super) fn settle(&mut self, gate: Gate) -> Result<()> {
        self.drop_unused_points();
        let skip = gate.below == Below::Skip;
        let places = Places::of(self);
        self.settle_duplicates(places.as_ref().map(|places| &places.first[..]), skip)?;
        self.settle_orientation(skip)?;
        self.pass(gate)?;
        // Removed cells have taken points with them.
        let left_out = self.quality.skipped + self.quality.duplicates + self.quality.folded > 0;
        let places = if left_out { Places::of(self) } else { places };
        self.quality.coincident = places.as_ref().map(Places::coincident);
        let mut overlapping = HashSet::new();
        self.quality.hanging = places.map(|places| self.hanging(&places, &mut overlapping));
        self.quality.overlapping = overlapping.len();
        let pieces = self.pieces();
        self.quality.crossing = self.crossing(&pieces);
        let pieces = pieces.len();
        self.quality.pieces = Some(pieces);
        let touch = |count: Option<usize>| count.is_some_and(|count| count > 0);
        self.quality.unwelded = (self.cell_dimension(), self.dimension) == (2, 3)
            && 2 * pieces > self.cell_count()
            && (touch(self.quality.coincident) || touch(self.quality.hanging));
        Ok(())
    }

    fn add_cells(&mut self, index: usize, block: &SourceBlock, format: Format) {
        let CellBlock { element, connectivity } = &mut self.blocks[index];
        let first = connectivity.len() / element.nodes();
        let order = entry(element, format).and_then(|e| e.order.clone());
        connectivity.reserve_exact(block.connectivity.len());
        match &order {
            Some(order) => {
                for nodes in block.connectivity.chunks_exact(block.nodes_per_cell) {
                    connectivity.extend(order.iter().map(|&place| nodes[place]));
                }
            }
            None => connectivity.extend_from_slice(&block.connectivity),
        }
        let last = connectivity.len() / element.nodes();
        for name in &block.groups {
            let group = self.groups.entry(name.clone()).or_default();
            group.cells.extend((first..last).map(|cell| CellIndex { block: index, cell }));
        }
    }

    /// Reverses reversed cells. If only some cells are reversed, those that are folded over their neighbours are
    /// refused or removed.
    fn settle_orientation(&mut self, skip: bool) -> Result<()> {
        let turned = self.orient(skip)?;
        let of_body: usize = self.body_blocks().map(|(_, block)| block.cells().len()).sum();
        // A mesh that is numbered the other way round as a whole has no folds to look for.
        if turned.is_empty() || turned.len() == of_body {
            return Ok(());
        }
        let folded = self.folded();
        if folded.is_empty() {
            // Only told: nothing lies there twice, so that the orders of the nodes alone differ.
            self.quality.turned = Some(self.named(&turned));
            return Ok(());
        }
        if !skip {
            let found = format!(
                "{} of {} folded over their neighbours: {}; below = \"skip\" leaves them out",
                folded.len(),
                self.cell_count(),
                self.named(&folded)
            );
            return Err(Error::expected("cells", "cells that lie on both sides of what they share", found));
        }
        let is_turned: HashSet<CellIndex> = turned.into_iter().collect();
        // The count of reversed cells does not include the cells that are removed.
        self.reversed = is_turned.len() - folded.iter().filter(|cell| is_turned.contains(cell)).count();
        self.quality.folded = folded.len();
        self.remove(&folded).map(drop)
    }

    /// Reverses reversed cells and checks that every cell has a volume; with `skip`, cells without a volume are
    /// removed. Returns the reversed cells.
    ///
    /// # Errors
    /// A cell has no volume and `skip` is not set, or no other cell is left.
    pub(super) fn orient(&mut self, skip: bool) -> Result<Vec<CellIndex>> {
        let mut turned = Vec::new();
        let mut faulty: Vec<(CellIndex, Fault)> = Vec::new();
        for (index, block) in self.blocks.iter_mut().enumerate() {
            let element = block.element.clone();
            let table = &element.tabulation;
            let mut geometry = Geometry::new(table);
            let mut placement = Placement::new(table);
            let mut x = vec![0.0; element.nodes() * element.dimension()];
            let mut set = |points: &[f64], nodes: &[usize]| {
                placement.place(table, points, nodes, &mut x)?;
                if Geometry::is_sound(table, &x) { Ok(()) } else { geometry.set(table, &x) }
            };
            for (cell, nodes) in block.connectivity.chunks_exact_mut(element.nodes()).enumerate() {
                let at = CellIndex { block: index, cell };
                let twice = |(i, node): (usize, &usize)| nodes[..i].contains(node);
                let fault = match (set(&self.points, nodes), &element.reflection) {
                    // A node that is there twice comes first: the Jacobian can still be positive at every point where it is taken.
                    _ if nodes.iter().enumerate().any(twice) => Some(Fault::Collapsed),
                    (Ok(()), _) => continue,
                    (Err(Fault::Reversed), Some(reflection)) => {
                        let other: Vec<usize> = reflection.iter().map(|&place| nodes[place]).collect();
                        nodes.copy_from_slice(&other);
                        // Measured again: a cell can be reversed at some points only, and then no order of its nodes helps.
                        let fault = set(&self.points, nodes).err();
                        turned.extend(fault.is_none().then_some(at));
                        fault
                    }
                    (Err(fault), _) => Some(fault),
                };
                faulty.extend(fault.map(|fault| (at, fault)));
            }
        }
        self.reversed = turned.len();
        let Some((first, fault)) = faulty.first() else { return Ok(turned) };
        if !skip {
            let others = match faulty.len() - 1 {
                0 => "; below = \"skip\" leaves the cell out".to_string(),
                count => format!(
                    "; the cells with such a fault are {} of {}; below = \"skip\" leaves them out",
                    count + 1,
                    self.cell_count()
                ),
            };
            return Err(Error::at(self.cell_name(*first), fault.to_string()).followed_by(others));
        }
        self.quality.skipped += faulty.len();
        let cells: Vec<CellIndex> = faulty.into_iter().map(|(cell, _)| cell).collect();
        let new = self.remove(&cells)?;
        // The cells have moved up by those that were removed before them.
        Ok(turned.into_iter().map(|at| CellIndex { cell: new[at.block][at.cell], ..at }).collect())
    }
}

/// The longest name of a group, characters: tables and scenes list names whole.
const LONGEST_NAME: usize = 1000;

/// That the names of groups can be listed.
fn check_names(source: &MeshSource) -> Result<()> {
    let lengths = source.blocks.iter().flat_map(|block| &block.groups).map(|name| (name.chars().count(), name));
    match lengths.max().filter(|(length, _)| *length > LONGEST_NAME) {
        Some((length, name)) => {
            let beginning: String = name.chars().take(40).collect();
            let found = format!("one of {length}, which begins with \"{beginning}\"");
            Err(Error::expected("groups", format!("names of at most {LONGEST_NAME} characters"), found))
        }
        None => Ok(()),
    }
}

/// That the coordinates, m, are in the range in which the program computes.
pub(super) fn check_size(coordinates: impl Iterator<Item = f64>) -> Result<()> {
    let largest = coordinates.map(f64::abs).fold(0.0, f64::max);
    if !range::contains(largest) {
        let expected =
            format!("coordinates of which the largest is between {:e} and {:e} m", range::LEAST, range::LARGEST);
        return Err(Error::expected("points", expected, format!("{largest:?} m")));
    }
    Ok(())
}

/// The numbers of the points in the file, if there is one.
fn numbering(source: &MeshSource) -> Option<Numbering> {
    // Points that a reader has made itself have no numbers in the file.
    let known = source.numbers.len() == source.points.len();
    known.then(|| Numbering { origin: source.origin, nodes: source.numbers.clone() })
}

fn entry(element: &Element, format: Format) -> Option<&FormatEntry> {
    match format {
        Format::Gmsh => element.formats.gmsh.as_ref(),
        Format::Vtk => element.formats.vtk.as_ref(),
    }
}

fn element_for(format: Format, block: &SourceBlock, own: &[Arc<Element>]) -> Result<Arc<Element>> {
    let number = block.cell_type;
    let serves = |element: &&Arc<Element>| entry(element, format).is_some_and(|e| e.cell_type == number);
    let shipped_number = |s: &crate::element::ElementFile| match format {
        Format::Gmsh => s.gmsh,
        Format::Vtk => s.vtk,
    };
    // Those of the user come before those that the program has, so that a type of cell can get other functions.
    let element = match own.iter().find(serves) {
        Some(element) => element.clone(),
        None => match SHIPPED.iter().find(|s| shipped_number(s) == Some(i64::from(number))) {
            Some(shipped) => Arc::new(Element::shipped(shipped)?),
            None => {
                // A block of cells without nodes is to be named, not divided by.
                let cells = block.connectivity.len() / block.nodes_per_cell.max(1);
                let known: Vec<_> = SHIPPED.iter().map(|s| s.name).collect();
                let expected = format!("cells of {} or of an element file you name", known.join(", "));
                let found = format!("{cells} cells of {format:?} type {number} with {} nodes", block.nodes_per_cell);
                return Err(Error::expected("cells", expected, found).of_kind(ErrorKind::Unsupported));
            }
        },
    };
    if element.nodes() != block.nodes_per_cell || element.dimension() != block.dimension {
        let expected =
            format!("{} nodes in {} dimensions as in {}", element.nodes(), element.dimension(), element.name);
        let found = format!("{} nodes in {}", block.nodes_per_cell, block.dimension);
        let way = "; polygons of more corners are read where they are flat: ParaView's filter Triangulate makes triangles of others";
        let error = Error::expected("cells", expected, found);
        // The number of polygons in VTK.
        let is_polygon = matches!(format, Format::Vtk) && number == 7;
        return Err(if is_polygon { error.followed_by(way) } else { error });
    }
    Ok(element)
}

/// Whether all used points have the same z.
fn in_one_plane(source: &MeshSource) -> bool {
    // Only points of cells: a file of Gmsh can keep the centres of its arcs, which may lie anywhere.
    let used = || source.blocks.iter().flat_map(|b| &b.connectivity).map(|&p| source.points[p]);
    let range = |k: usize| used().fold((f64::MAX, f64::MIN), |(lo, hi), p| (lo.min(p[k]), hi.max(p[k])));
    let (lo, hi) = range(2);
    let extent = (0..2).map(|k| range(k).1 - range(k).0).fold(0.0, f64::max);
    // A program that turns a plane mesh leaves rounding across it.
    hi - lo <= 1e-9 * extent
}
