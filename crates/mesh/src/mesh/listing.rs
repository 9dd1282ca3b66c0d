//! Numbered nodes and cells, and the groups that list them by number, as finite element programs write them.

use super::annotations::Annotations;
use super::grouping::{Gather, Gathered};
use super::indices::Indices;
use super::numbering::NumberOrigin;
use super::polytope::CellType;
use super::source::{Format, MeshSource, SourceBlock};
use crate::error::{Error, ErrorKind, Result};
use std::collections::{BTreeMap, HashSet};

/// What a file of numbered nodes and cells holds.
#[derive(Default, Clone)]
pub(super) struct Listing {
    pub node_numbers: Vec<u64>,
    pub points: Vec<[f64; 3]>,
    pub cells: CellList,
}

/// Cells in the order of the file, with the numbers of their nodes.
#[derive(Default, Clone)]
pub(super) struct CellList {
    pub numbers: Vec<u64>,
    types: Vec<CellType>,
    ends: Vec<usize>,
    nodes: Vec<u64>,
    lines: Vec<usize>,
}

impl CellList {
    /// Adds a cell of this line with its nodes in the order of VTK.
    pub fn push(&mut self, line: usize, number: u64, cell_type: CellType, nodes: impl IntoIterator<Item = u64>) {
        self.lines.push(line);
        self.numbers.push(number);
        self.types.push(cell_type);
        self.nodes.extend(nodes);
        self.ends.push(self.nodes.len());
    }

    pub fn len(&self) -> usize {
        self.types.len()
    }

    /// Adds to the numbers of all nodes and cells; `None` if one becomes too large.
    pub fn shift(&mut self, nodes: u64, cells: u64) -> Option<()> {
        let grown = |number: &mut u64, by: u64| number.checked_add(by).map(|new| *number = new);
        self.nodes.iter_mut().try_for_each(|number| grown(number, nodes))?;
        self.numbers.iter_mut().try_for_each(|number| grown(number, cells))
    }

    /// Adds the cells of another list.
    pub fn append(&mut self, mut other: CellList) {
        let first = self.nodes.len();
        self.numbers.append(&mut other.numbers);
        self.types.append(&mut other.types);
        self.ends.extend(other.ends.iter().map(|end| first + end));
        self.nodes.append(&mut other.nodes);
        self.lines.append(&mut other.lines);
    }

    pub fn cell_type(&self, cell: usize) -> CellType {
        self.types[cell]
    }

    /// Changes the numbers of the nodes of a cell.
    ///
    /// # Panics
    /// There are more or fewer.
    pub fn set_nodes(&mut self, cell: usize, nodes: &[u64]) {
        let range = self.range(cell);
        self.nodes[range].copy_from_slice(nodes);
    }

    /// The numbers of the nodes of a cell.
    pub fn nodes(&self, cell: usize) -> &[u64] {
        &self.nodes[self.range(cell)]
    }

    fn range(&self, cell: usize) -> std::ops::Range<usize> {
        cell.checked_sub(1).map_or(0, |before| self.ends[before])..self.ends[cell]
    }
}

/// Nodes and cells whose numbers have been found.
pub(super) struct Resolved {
    pub node_numbers: Vec<u64>,
    points: Vec<[f64; 3]>,
    pub nodes: Indices,
    pub cells: Indices,
    pub list: CellList,
    /// The indices of the nodes of all cells, as in `list`.
    connectivity: Vec<usize>,
    groups: Groups,
}

/// Members of groups by name.
#[derive(Default)]
struct Groups {
    /// The names, and their numbers by what is compared: names that differ in upper and lower case are the same.
    names: Vec<String>,
    numbers: BTreeMap<String, u32>,
    /// A cell and a group.
    cells: Vec<(u32, u32)>,
    /// A group and a node.
    nodes: Vec<(u32, u32)>,
    sides: Vec<(u32, CellType, Vec<usize>)>,
    /// How many members may still be counted.
    left: usize,
}

impl Listing {
    /// Finds the nodes of the cells in a file of `length` bytes, in which cells are called `cell` (`element`).
    ///
    /// # Errors
    /// A number occurs twice, or a cell names a node that is not there.
    pub fn resolve(self, length: usize, cell: &str) -> Result<Resolved> {
        let twice =
            |what: &str, number: u64| Error::new(format!("{what} {number} occurs twice")).of_kind(ErrorKind::Syntax);
        let nodes = Indices::of(&self.node_numbers).map_err(|number| twice("node", number))?;
        let cells = Indices::of(&self.cells.numbers).map_err(|number| twice(cell, number))?;
        let mut connectivity = Vec::with_capacity(self.cells.nodes.len());
        for i in 0..self.cells.len() {
            for &number in &self.cells.nodes[self.cells.range(i)] {
                let Some(node) = nodes.index(number) else {
                    let key = format!("{cell} {}", self.cells.numbers[i]);
                    return Err(missing(key, self.cells.lines[i], "node", number));
                };
                connectivity.push(node);
            }
        }
        let mut list = self.cells;
        list.nodes = Vec::new();
        // A group is a name and its members, each at least two characters, except where a line stands for a range.
        let groups = Groups { left: (1 << 20) + 4 * length, ..Groups::default() };
        Ok(Resolved { node_numbers: self.node_numbers, points: self.points, nodes, cells, list, connectivity, groups })
    }
}

impl Resolved {
    pub fn cell_nodes(&self, cell: usize) -> &[usize] {
        &self.connectivity[self.list.range(cell)]
    }

    /// The number of the group with this name.
    pub fn group(&mut self, name: &str) -> u32 {
        let groups = &mut self.groups;
        let next = groups.names.len() as u32;
        let number = *groups.numbers.entry(name.to_lowercase()).or_insert(next);
        if number == next {
            groups.names.push(name.to_string());
        }
        number
    }

    /// Counts so many members, or numbers that could be members.
    ///
    /// # Errors
    /// There are more than a file of this length lists.
    pub fn charge(&mut self, members: usize) -> Result<()> {
        let groups = &mut self.groups;
        groups.left = groups.left.checked_sub(members).ok_or_else(|| {
            Error::expected("groups", "fewer members in a file of this length", "more").of_kind(ErrorKind::Limit)
        })?;
        Ok(())
    }

    pub fn add_cell(&mut self, group: u32, cell: usize) -> Result<()> {
        // Cells beyond 2³² would take more than a hundred gigabytes before they come here: 32 bits number them, in half
        // of the memory.
        self.groups.cells.push((cell as u32, group));
        self.charge(1)
    }

    pub fn add_node(&mut self, group: u32, node: usize) -> Result<()> {
        self.groups.nodes.push((group, node as u32));
        self.charge(1)
    }

    /// Adds a side by its nodes.
    pub fn add_face(&mut self, group: u32, cell_type: CellType, nodes: Vec<usize>) -> Result<()> {
        self.groups.sides.push((group, cell_type, nodes));
        self.charge(1)
    }

    /// Adds the side with this index of a cell; a cell without such a side adds nothing. Whether the cell has one.
    pub fn add_side(&mut self, group: u32, cell: usize, index: usize) -> Result<bool> {
        let side = self.list.cell_type(cell).side(index, self.cell_nodes(cell));
        let is_there = side.is_some();
        side.map_or(Ok(()), |(cell_type, nodes)| self.add_face(group, cell_type, nodes))?;
        Ok(is_there)
    }

    /// The sides that belong to one cell alone among the cells of the highest dimension.
    pub fn outer_sides(&self) -> HashSet<(usize, usize)> {
        let top = (0..self.list.len()).map(|cell| self.list.cell_type(cell).dimension()).max().unwrap_or(0);
        let mut met: BTreeMap<Vec<usize>, Option<(usize, usize)>> = BTreeMap::new();
        for cell in (0..self.list.len()).filter(|&cell| self.list.cell_type(cell).dimension() == top) {
            let nodes = self.cell_nodes(cell);
            for (index, corners) in self.list.cell_type(cell).sides().iter().enumerate() {
                let mut key: Vec<usize> = corners.iter().map(|&a| nodes[a]).collect();
                key.sort_unstable();
                // A side that a second cell has is inside. The map is ordered, so that sides come in the same order in
                // each run.
                met.entry(key).and_modify(|first| *first = None).or_insert(Some((cell, index)));
            }
        }
        met.into_values().flatten().collect()
    }

    /// Says which elements of the body are something else here: `counts` has how many there are of each type, and their dimension, and `stand_in` says
    /// in words what those of a type are.
    pub fn tell_stand_ins(
        &self,
        counts: &BTreeMap<String, (usize, usize)>,
        stand_in: impl Fn(&str) -> Option<&'static str>,
        annotations: &mut Annotations,
    ) {
        let top = (0..self.list.len()).map(|cell| self.list.cell_type(cell).dimension()).max().unwrap_or(0);
        for (name, (count, dimension)) in counts {
            if let Some(what) = stand_in(name).filter(|_| *dimension == top) {
                let elements = if *count == 1 { "element is" } else { "elements are" };
                annotations.remark(format!("{count} {name} {elements} {what} here"));
            }
        }
    }

    /// The blocks: cells of one type in the same groups, then the points and sides of each group. `annotations` is what else the file says.
    pub fn into_source(mut self, annotations: Annotations) -> MeshSource {
        let Groups { names, mut cells, mut nodes, mut sides, .. } = std::mem::take(&mut self.groups);
        let named = |groups: &[u32]| groups.iter().map(|&group| names[group as usize].clone()).collect::<Vec<_>>();
        // A deck may name a cell twice in a group. Sorted by cell, the groups of each are met while cells are passed in
        // order.
        cells.sort_unstable();
        cells.dedup();
        let mut members = cells.into_iter().peekable();
        let mut gather: Gather<(CellType, Vec<u32>)> = Gather::new();
        let mut key = (CellType::POINT, Vec::new());
        for cell in 0..self.list.len() {
            key.0 = self.list.cell_type(cell);
            key.1.clear();
            while let Some((_, group)) = members.next_if(|(member, _)| *member as usize == cell) {
                key.1.push(group);
            }
            gather.list(&key).extend_from_slice(self.cell_nodes(cell));
        }
        let block = |Gathered { key: (cell_type, groups), nodes, runs }: Gathered<(CellType, Vec<u32>)>| SourceBlock {
            runs,
            ..cell_type.cells(nodes, named(&groups))
        };
        let mut blocks: Vec<SourceBlock> = gather.into_lists().map(block).collect();
        // Sorted by group, each run of the list becomes a block.
        nodes.sort_unstable();
        nodes.dedup();
        for members in nodes.chunk_by(|a, b| a.0 == b.0) {
            let list = members.iter().map(|(_, node)| *node as usize).collect();
            blocks.push(CellType::POINT.block(list, named(&[members[0].0])));
        }
        sides.sort_unstable_by_key(|(group, cell_type, _)| (*group, cell_type.0));
        for members in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let list = members.iter().flat_map(|(.., nodes)| nodes).copied().collect();
            blocks.push(members[0].1.block(list, named(&[members[0].0])));
        }
        MeshSource {
            format: Format::Vtk,
            origin: NumberOrigin::NodeNumber,
            points: self.points,
            numbers: self.node_numbers,
            blocks,
            space: None,
            annotations,
        }
    }
}

/// The error for a line that names a node or a cell that is not there.
pub(super) fn missing(key: String, line: usize, what: &str, number: u64) -> Error {
    Error::at(key, format!("names {what} {number}, which the file lacks")).of_kind(ErrorKind::Syntax).on_line(line)
}
