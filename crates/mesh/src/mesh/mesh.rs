//! The points, cells and groups of a mesh.

use super::annotations::Annotations;
use super::numbering::Numbering;
use super::quality::Quality;
use crate::element::Element;
use crate::springs::norm;
use crate::symbolic::Predicate;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Points, cells of known elements, and groups. Every point is a node of a cell or a director, and every cell has a positive volume.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// The dimension of the space, 2 or 3. The cells of a surface or curve have fewer.
    pub dimension: usize,
    /// The positions at rest, `[points × dimension]`, m.
    pub points: Vec<f64>,
    /// The cells, one block per element type.
    pub blocks: Vec<CellBlock>,
    /// The directors of a sheet or of rods that bend, which are the last points.
    pub directors: Option<Directors>,
    /// The groups by name.
    pub groups: BTreeMap<String, Group>,
    /// Conditions with what they select, where this was chosen on a coarser mesh of the body, see [`Mesh::choose`].
    pub conditions: Vec<Chosen>,
    /// The number of cells that were numbered in the opposite order and have been reversed.
    pub reversed: usize,
    /// The number of points of the file that belong to no cell and were removed.
    pub unused_points: usize,
    /// What the file says besides the body.
    pub annotations: Annotations,
    /// The numbers of the points in the file; `None` for a mesh that is generated or refined.
    pub numbering: Option<Numbering>,
    /// The quality of the cells.
    pub quality: Quality,
}

/// The directors of a sheet or of rods. They are the last points of the mesh, and no cell has them as nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Directors {
    /// The ends of the edge of each director of a sheet, ascending; of a director of rods the joint that it turns with, twice.
    pub edges: Vec<[usize; 2]>,
    /// The points that are the directors of the cells, cell after cell: of a triangle those of the edges opposite to its corners, of a rod the two of its first
    /// end and the two of its second.
    pub of_cells: Vec<usize>,
    /// The square of the radius of gyration of each cell, m²: `t²/12` of a plate of thickness t, which resists curvature by that times the stiffness of the
    /// membrane, and `I/A` of a rod.
    pub gyration: Vec<f64>,
    /// `G J/(E A)` of each rod, m², by which it resists torsion; none of a sheet.
    pub torsion: Vec<f64>,
    /// Whether the sheet is without bending where it is flat, and not as it is. Edges of three triangles and more keep their angles.
    pub flat: bool,
}

impl Directors {
    /// The points that are the directors of a cell.
    pub fn of_cell(&self, cell: usize) -> &[usize] {
        // There is one radius of gyration for each cell, and as many directors of each.
        let each = self.of_cells.len() / self.gyration.len();
        &self.of_cells[cell * each..(cell + 1) * each]
    }
}

/// The cells of one element type.
#[derive(Debug, Clone)]
pub struct CellBlock {
    /// The element of the cells.
    pub element: Arc<Element>,
    /// The points of the cells in the node order of the element, `[cells × nodes]`.
    pub connectivity: Vec<usize>,
}

/// Points, sides, edges and cells with one name. A file may list them one beside the other: finite element programs have a set of nodes and a set of
/// elements of one name, meshes a tag in several dimensions. They need not be of the same part of the body.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Group {
    /// The points that the name stands for, ascending: those that are listed as such, or else those of the listed part of the lowest dimension.
    pub points: Vec<usize>,
    /// Whether the points are listed as such, beside the sides, edges and cells and not because these have them.
    pub lists_points: bool,
    /// The sides, each by its points in ascending order.
    pub sides: Vec<Vec<usize>>,
    /// The edges of curves in a solid, each by its points in ascending order.
    pub edges: Vec<Vec<usize>>,
    /// The cells.
    pub cells: Vec<CellIndex>,
}

/// What a condition on the coordinates selects.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// The condition.
    pub condition: Predicate,
    /// The points where it holds, ascending.
    pub points: Vec<usize>,
    /// The cells at whose middle it holds; `None` where no cells are asked for.
    pub cells: Option<Vec<CellIndex>>,
}

/// A cell of a mesh, by its block and its index in the block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct CellIndex {
    /// The index of the block.
    pub block: usize,
    /// The index of the cell in its block.
    pub cell: usize,
}

/// A side of a cell, by its index in the element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SideIndex {
    /// The cell.
    pub cell: CellIndex,
    /// The index of the side, in the order of [`Element::sides`].
    pub side: usize,
}

impl Group {
    /// Whether its points are those of no side, edge or cell that it lists.
    pub fn is_of_points(&self) -> bool {
        self.lists_points || (self.sides.is_empty() && self.edges.is_empty() && self.cells.is_empty())
    }
}

impl CellBlock {
    /// The points of a cell, `[nodes]`.
    ///
    /// # Panics
    /// There is no such cell.
    pub fn cell(&self, cell: usize) -> &[usize] {
        let n = self.element.nodes();
        &self.connectivity[cell * n..(cell + 1) * n]
    }

    /// The points of each cell, `[nodes]`.
    pub fn cells(&self) -> impl ExactSizeIterator<Item = &[usize]> {
        self.connectivity.chunks_exact(self.element.nodes())
    }
}

impl Mesh {
    /// Points, `[points × dimension]`, m, and cells on them, without groups. The cells are not checked.
    pub fn of_cells(dimension: usize, points: Vec<f64>, blocks: Vec<CellBlock>) -> Mesh {
        let (groups, conditions, quality, annotations) = Default::default();
        Mesh {
            dimension,
            points,
            blocks,
            directors: None,
            groups,
            conditions,
            reversed: 0,
            unused_points: 0,
            annotations,
            numbering: None,
            quality,
        }
    }

    /// Points without cells, of which a mesh is built.
    pub(super) fn of_points(dimension: usize, points: Vec<f64>) -> Mesh {
        Mesh::of_cells(dimension, points, Vec::new())
    }

    /// The number of points.
    pub fn point_count(&self) -> usize {
        self.points.len() / self.dimension
    }

    /// The number of cells.
    pub fn cell_count(&self) -> usize {
        self.blocks.iter().map(|b| b.cells().len()).sum()
    }

    /// The dimension of the body: 3 for solids, 2 for surfaces, 1 for curves. Its cells come first.
    pub fn cell_dimension(&self) -> usize {
        self.blocks.first().map_or(self.dimension, |b| b.element.dimension())
    }

    /// The blocks whose cells have the dimension of the body, with their indices. Others are attached to it: membranes on a solid, rods in it.
    pub fn body_blocks(&self) -> impl Iterator<Item = (usize, &CellBlock)> {
        let dimension = self.cell_dimension();
        self.blocks.iter().enumerate().filter(move |(_, block)| block.element.dimension() == dimension)
    }

    /// Whether cells of fewer dimensions are attached to the body.
    pub fn is_mixed(&self) -> bool {
        self.body_blocks().count() < self.blocks.len()
    }

    /// Whether a cell has the dimension of the body.
    pub fn is_of_body(&self, cell: CellIndex) -> bool {
        self.blocks[cell.block].element.dimension() == self.cell_dimension()
    }

    /// The coordinates of one point, `[dimension]`, m.
    pub fn point(&self, index: usize) -> &[f64] {
        &self.points[index * self.dimension..(index + 1) * self.dimension]
    }

    /// The number of a point in its file; in a mesh without a file its index, which files of networks have as well.
    pub fn point_number(&self, index: usize) -> u64 {
        self.numbering.as_ref().map_or(index as u64, |numbering| numbering.nodes[index])
    }

    /// A point in words: `node 17` by its number in the file, or `point 4` by its index in a mesh without a file.
    pub fn point_title(&self, index: usize) -> String {
        format!("{} {}", self.point_word(), self.point_number(index))
    }

    /// What the numbers of points are: `node` of those in the file, `point` of indices.
    pub fn point_word(&self) -> &'static str {
        if self.numbering.is_some() { "node" } else { "point" }
    }

    /// CRC-32 of the points as little-endian numbers of 64 bits, followed by the cells as integers of 32 bits.
    pub fn checksum(&self) -> u32 {
        let mut crc = flate2::Crc::new();
        self.points.iter().for_each(|x| crc.update(&x.to_le_bytes()));
        let points = self.blocks.iter().flat_map(|block| &block.connectivity);
        points.for_each(|&p| crc.update(&(p as u32).to_le_bytes()));
        crc.sum()
    }

    /// One cell alone, without its groups. Its points are in the order of its nodes.
    pub fn of_cell(&self, index: CellIndex) -> Mesh {
        let nodes = self.cell_nodes(index);
        let points = nodes.iter().flat_map(|&p| self.point(p)).copied().collect();
        let element = self.blocks[index.block].element.clone();
        let block = CellBlock { element, connectivity: (0..nodes.len()).collect() };
        Mesh { blocks: vec![block], ..Mesh::of_points(self.dimension, points) }
    }

    /// The first cells of each block, at most so many, without their groups. Their points are in the order in which the cells have them.
    pub fn of_first_cells(&self, count: usize) -> Mesh {
        // The number of each point from 1; 0 of one that no cell has had yet.
        let mut numbers = vec![0; self.point_count()];
        let mut points = Vec::new();
        let mut place = |point: usize| {
            if numbers[point] == 0 {
                points.extend_from_slice(self.point(point));
                numbers[point] = points.len() / self.dimension;
            }
            numbers[point] - 1
        };
        let mut first = |block: &CellBlock| {
            let kept = count.min(block.cells().len()) * block.element.nodes();
            let connectivity = block.connectivity[..kept].iter().map(|&point| place(point)).collect();
            CellBlock { element: block.element.clone(), connectivity }
        };
        let blocks = self.blocks.iter().map(&mut first).collect();
        Mesh { quality: self.quality.clone(), ..Mesh::of_cells(self.dimension, points, blocks) }
    }

    /// The least and the largest coordinate of the nodes along each axis, m.
    pub fn ranges(&self) -> Vec<[f64; 2]> {
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.dimension];
        // Directors come after the nodes. They stand beside the body and are no part of it.
        for x in self.points.chunks_exact(self.dimension).take(self.node_count()) {
            for ([least, largest], x) in ranges.iter_mut().zip(x) {
                (*least, *largest) = (least.min(*x), largest.max(*x));
            }
        }
        ranges
    }

    /// The size of the box around the nodes along each axis, m.
    pub fn extent(&self) -> Vec<f64> {
        self.ranges().into_iter().map(|[least, largest]| largest - least).collect()
    }

    /// The longest side of the box around the nodes, m.
    pub fn longest_side(&self) -> f64 {
        self.extent().into_iter().fold(0.0, f64::max)
    }

    /// The largest size of the vectors of its nodes, `[points × dimension]`, such as displacements in m; those of directors are left out.
    pub fn largest_motion(&self, of_points: &[f64]) -> f64 {
        of_points.chunks_exact(self.dimension).take(self.node_count()).map(norm).fold(0.0, f64::max)
    }

    /// The names of the groups to which each cell belongs, by block and cell.
    pub fn regions(&self) -> Vec<Vec<Vec<&str>>> {
        let mut regions: Vec<Vec<Vec<&str>>> = self.blocks.iter().map(|b| vec![Vec::new(); b.cells().len()]).collect();
        for (name, group) in &self.groups {
            group.cells.iter().for_each(|cell| regions[cell.block][cell.cell].push(name));
        }
        regions
    }

    /// The middle of a cell, the mean of its nodes, `[dimension]`, m.
    pub fn middle(&self, cell: CellIndex) -> Vec<f64> {
        self.mean_place(self.cell_nodes(cell))
    }

    /// The mean of some points, `[dimension]`, m.
    pub fn mean_place(&self, points: &[usize]) -> Vec<f64> {
        let along = |k: usize| points.iter().map(|&p| self.point(p)[k]).sum::<f64>() / points.len() as f64;
        (0..self.dimension).map(along).collect()
    }

    /// The points of one cell, in the node order of its element.
    pub fn cell_nodes(&self, CellIndex { block, cell }: CellIndex) -> &[usize] {
        self.blocks[block].cell(cell)
    }

    /// Every cell, block by block.
    pub fn cell_indices(&self) -> impl Iterator<Item = CellIndex> {
        let counts = self.blocks.iter().map(|block| block.cells().len()).enumerate();
        counts.flat_map(|(block, count)| (0..count).map(move |cell| CellIndex { block, cell }))
    }

    /// The points of one side.
    pub(super) fn side_points(&self, index: &SideIndex) -> impl Iterator<Item = usize> + '_ {
        let nodes = self.cell_nodes(index.cell);
        self.blocks[index.cell.block].element.sides()[index.side].nodes.iter().map(|&a| nodes[a])
    }

    pub(super) fn side_nodes(&self, index: &SideIndex) -> Vec<usize> {
        self.side_points(index).collect()
    }

    /// The sides of the cells of the body.
    pub(super) fn side_indices(&self) -> impl Iterator<Item = SideIndex> {
        let sides = |cell: CellIndex| 0..self.blocks[cell.block].element.sides().len();
        self.cell_indices()
            .filter(|cell| self.is_of_body(*cell))
            .flat_map(move |cell| sides(cell).map(move |side| SideIndex { cell, side }))
    }

    /// Removes the points that belong to no cell.
    pub(super) fn drop_unused_points(&mut self) {
        let total = self.points.len() / self.dimension;
        let mut new = vec![usize::MAX; total];
        self.blocks.iter().flat_map(|b| &b.connectivity).for_each(|&p| new[p] = 0);
        let mut used = 0;
        for (old, new) in new.iter_mut().enumerate() {
            if *new == 0 {
                *new = used;
                // No point moves back: its new place holds one that has been moved already, or itself.
                self.points.copy_within(old * self.dimension..(old + 1) * self.dimension, used * self.dimension);
                if let Some(numbering) = &mut self.numbering {
                    numbering.nodes[used] = numbering.nodes[old];
                }
                used += 1;
            }
        }
        self.points.truncate(used * self.dimension);
        if let Some(numbering) = &mut self.numbering {
            numbering.nodes.truncate(used);
        }
        self.unused_points = total - used;
        self.blocks.iter_mut().flat_map(|b| &mut b.connectivity).for_each(|p| *p = new[*p]);
        for group in self.groups.values_mut() {
            let renumber = |points: &mut Vec<usize>| {
                points.retain(|&p| new[p] != usize::MAX);
                points.iter_mut().for_each(|p| *p = new[*p]);
                points.sort_unstable();
            };
            renumber(&mut group.points);
            group.points.dedup();
            group.sides.iter_mut().chain(&mut group.edges).for_each(renumber);
        }
        for Chosen { points, .. } in &mut self.conditions {
            points.retain(|&p| new[p] != usize::MAX);
            points.iter_mut().for_each(|p| *p = new[*p]);
        }
    }
}

/// The points of a side in ascending order.
pub(super) fn sorted(points: &[usize]) -> Vec<usize> {
    let mut points = points.to_vec();
    points.sort_unstable();
    points
}
