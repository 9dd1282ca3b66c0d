//! Finer meshes of the same body: every cell is divided so that all edges are halved, or gets quadratic functions.

mod children;
mod filling;
mod memberships;
mod pattern;

use super::mesh::{CellBlock, CellIndex, Mesh, sorted};
use super::places::Places;
use super::quality::{Below, Gate};
use crate::element::{Cell, Element};
use crate::error::Result;
use crate::springs::distance;
use children::DIAGONALS;
use filling::{filling, quadratic};
use memberships::{Memberships, Part};
use pattern::Pattern;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Lengths that differ by less than this share are equal, so that rounding does not choose the diagonal.
const TIE: f64 = 1e-9;

impl Mesh {
    /// Divides the cells of the body into cells of half the size: an interval is divided into two, a triangle or quadrilateral into
    /// four, a tetrahedron, hexahedron or wedge into eight, a pyramid into six pyramids and four tetrahedra.
    ///
    /// New points are at the positions that the shape functions of the cell give, `x = Σ_a N_a x_a`. The geometry is
    /// kept: curved cells stay curved if the shape functions of the parts can represent this, and polygons stay
    /// polygons. A tetrahedron is divided along its shortest diagonal. The sides, edges and cells of a group are
    /// divided with the cells, and their new points belong to the group. Points of a group that are on none of them
    /// stay in it. A group of points alone, and what a condition selects (see [`Mesh::choose`]), also has the new points on edges, sides and
    /// cells all of whose points it has. Old points keep their numbers.
    ///
    /// # Errors
    /// A cell cannot be divided; a group has sides that no cell has; or a part of a curved cell has no volume.
    pub fn refined(&self) -> Result<Mesh> {
        let mut elements: Vec<Arc<Element>> = self.blocks.iter().map(|block| block.element.clone()).collect();
        let divisions = self.blocks.iter().map(|block| Division::of(&block.element, &mut elements));
        let divisions = divisions.collect::<Result<_>>()?;
        self.divided(elements, divisions)
    }

    /// Gives the cells quadratic functions: each has a point in the middle of every edge besides its corners. Groups and what conditions
    /// select have the new points as in [`Mesh::refined`].
    ///
    /// # Errors
    /// A cell has other nodes than its corners, or is of a kind of which no element with quadratic functions is shipped.
    pub fn elevated(&self) -> Result<Mesh> {
        let elements =
            self.blocks.iter().map(|block| quadratic(&block.element)).collect::<Result<Vec<Arc<Element>>>>()?;
        let pairs = self.blocks.iter().zip(&elements).enumerate();
        let divisions = pairs.map(|(index, (block, element))| Division::of_whole(&block.element, element, index));
        let divisions = divisions.collect::<Result<_>>()?;
        self.divided(elements, divisions)
    }

    /// The mesh with each block divided; `elements` are those of the blocks of the new mesh.
    fn divided(&self, elements: Vec<Arc<Element>>, divisions: Vec<Division>) -> Result<Mesh> {
        let mut fine = Mesh { blocks: Vec::new(), numbering: None, ..self.clone() };
        fine.blocks.extend(elements.into_iter().map(|element| CellBlock { element, connectivity: Vec::new() }));
        let mut memberships = Memberships::of(self);
        let asks_cells = self.conditions.iter().any(|chosen| chosen.cells.is_some());
        let mut all_parts: HashMap<CellIndex, Vec<CellIndex>> = HashMap::new();
        let mut glue = Glue::default();
        for (index, (block, division)) in self.blocks.iter().zip(&divisions).enumerate() {
            for (cell, nodes) in block.cells().enumerate() {
                let pattern = division.pattern(self, nodes);
                let points: Vec<usize> =
                    pattern.points.iter().map(|values| glue.point(values, nodes, &mut fine)).collect();
                let mut parts = Vec::new();
                for (kind, places) in &pattern.cells {
                    let block = if *kind == self.blocks[index].element.cell { index } else { division.filling };
                    let target = &mut fine.blocks[block];
                    parts.push(CellIndex { block, cell: target.cells().len() });
                    target.connectivity.extend(places.iter().map(|&p| points[p]));
                }
                if asks_cells {
                    all_parts.insert(CellIndex { block: index, cell }, parts.clone());
                }
                memberships.divide_cell(CellIndex { block: index, cell }, &parts, &points);
                let own = |places: &[usize]| sorted(&places.iter().map(|&p| points[p]).collect::<Vec<_>>());
                if memberships.has(Part::Sides) {
                    for (side, parts) in block.element.sides().iter().zip(&pattern.sides) {
                        memberships.divide(Part::Sides, own(&side.nodes), parts.iter().map(|part| own(part)));
                    }
                }
                if memberships.has(Part::Edges) {
                    for (edge, parts) in &pattern.edges {
                        memberships.divide(Part::Edges, own(edge), parts.iter().map(|part| own(part)));
                    }
                }
            }
        }
        fine.groups = memberships.into_groups()?;
        for group in fine.groups.values_mut().filter(|group| group.is_of_points()) {
            glue.complete(&mut group.points);
        }
        for chosen in &mut fine.conditions {
            glue.complete(&mut chosen.points);
            let divided = |cells: Vec<CellIndex>| cells.iter().flat_map(|cell| all_parts[cell].clone()).collect();
            chosen.cells = chosen.cells.take().map(divided);
        }
        fine.drop_unused_points();
        // The count that is told is that of the file, not of the nodes that no part took over.
        fine.unused_points = self.unused_points;
        // The parts of a curved cell can be reversed where the cell itself is not at the points of its own rule.
        fine.orient(false).map_err(|e| e.followed_by(" after the cells were divided"))?;
        // The cells of the file were reversed before they were divided.
        fine.reversed = self.reversed;
        if self.quality.coincident.is_some() {
            fine.quality.coincident = Places::of(&fine).map(|places| places.coincident());
        }
        // The quality is that of the coarse mesh; the fine cells are not measured.
        fine.quality.hanging = None;
        fine.quality.pieces = self.quality.pieces;
        if self.quality.worst.is_some() {
            fine.pass(Gate { least: self.quality.least, below: Below::Warn })?;
        }
        Ok(fine)
    }
}

/// The ways to divide the cells of one element.
struct Division {
    /// One pattern, or one for each diagonal of a tetrahedron.
    patterns: Vec<Pattern>,
    /// For each diagonal its ends, as points of the midpoints of the first pattern.
    diagonals: Vec<[Vec<(usize, f64)>; 2]>,
    /// The block of the parts that are of another kind.
    filling: usize,
}

impl Division {
    /// `elements` are those of the blocks; a further one that is required is added.
    fn of(element: &Arc<Element>, elements: &mut Vec<Arc<Element>>) -> Result<Division> {
        let other = children::children(element.cell, 0).iter().map(|part| part.cell).find(|cell| *cell != element.cell);
        let mut filling_block = 0;
        if let Some(cell) = other {
            let filling = filling(element, cell, elements)?;
            let place = elements.iter().position(|known| known.name == filling.name);
            filling_block = place.unwrap_or(elements.len());
            if place.is_none() {
                elements.push(filling);
            }
        }
        let filling = elements[filling_block].clone();
        let element_of = |cell: Cell| Ok(if cell == element.cell { &**element } else { &*filling });
        let is_tetrahedron = element.cell == Cell::Tetrahedron;
        let ways = if is_tetrahedron { DIAGONALS.len() } else { 1 };
        let pattern = |way: usize| Pattern::of(element, children::children(element.cell, way), &element_of);
        let patterns = (0..ways).map(pattern).collect::<Result<Vec<_>>>()?;
        let end = |pair: [usize; 2]| -> Vec<(usize, f64)> {
            let corners = element.cell.corners();
            let at: Vec<f64> = corners[pair[0]].iter().zip(corners[pair[1]]).map(|(a, b)| (a + b) / 2.0).collect();
            element.functions.values.iter().map(|n| n.evaluate(&at)).enumerate().collect()
        };
        let diagonals = if is_tetrahedron { DIAGONALS.map(|ends| ends.map(end)).to_vec() } else { Vec::new() };
        Ok(Division { patterns, diagonals, filling: filling_block })
    }

    /// A cell that stays whole and gets another element of the same kind, in the block with this index.
    fn of_whole(element: &Element, other: &Element, block: usize) -> Result<Division> {
        let pattern = Pattern::of(element, children::whole(element.cell), &|_| Ok(other))?;
        Ok(Division { patterns: vec![pattern], diagonals: Vec::new(), filling: block })
    }

    /// The division of the cell with these nodes: along its shortest diagonal, the first of equal ones.
    fn pattern(&self, mesh: &Mesh, nodes: &[usize]) -> &Pattern {
        let mut shortest = (0, f64::INFINITY);
        for (way, ends) in self.diagonals.iter().enumerate() {
            let [from, to] = [0, 1].map(|end| place(mesh, nodes, &ends[end]));
            let length = distance(&from, &to);
            if length < shortest.1 * (1.0 - TIE) {
                shortest = (way, length);
            }
        }
        &self.patterns[shortest.0]
    }
}

/// `x = Σ_a N_a x_a`.
fn place(mesh: &Mesh, nodes: &[usize], values: &[(usize, f64)]) -> Vec<f64> {
    (0..mesh.dimension).map(|k| values.iter().map(|&(a, n)| n * mesh.point(nodes[a])[k]).sum()).collect()
}

/// The new points. Neighbours share the shape functions of the side between them, and all others vanish there. The
/// nodes with nonzero functions, with their values in units of 2⁻³⁰, therefore identify a point, even if points of two
/// bodies coincide.
#[derive(Default)]
struct Glue {
    known: HashMap<Vec<(usize, i64)>, usize>,
}

impl Glue {
    /// The point where the shape functions of a cell have these values.
    fn point(&mut self, values: &[(usize, f64)], nodes: &[usize], fine: &mut Mesh) -> usize {
        // A point where only one function does not vanish is that node.
        if let [(a, _)] = values {
            return nodes[*a];
        }
        let mut key: Vec<(usize, i64)> =
            // A new point is the sum of some nodes with these weights, and the same from whichever cell it is seen;
            // weights differ by rounding.
            values.iter().map(|&(a, n)| (nodes[a], (n * (1u64 << 30) as f64).round() as i64)).collect();
        key.sort_unstable();
        *self.known.entry(key).or_insert_with(|| {
            let at = place(fine, nodes, values);
            fine.points.extend(at);
            fine.point_count() - 1
        })
    }

    /// Adds the new points where only functions of these points do not vanish.
    fn complete(&self, points: &mut Vec<usize>) {
        let old: HashSet<usize> = points.iter().copied().collect();
        let carried = self.known.iter().filter(|(nodes, _)| nodes.iter().all(|(node, _)| old.contains(node)));
        points.extend(carried.map(|(_, &point)| point));
        points.sort_unstable();
    }
}
