//! Parts of a mesh, selected by group name or by a condition on the coordinates.

use super::embedding::Embedding;
use super::mesh::{CellBlock, CellIndex, Chosen, Group, Mesh, SideIndex, sorted};
use crate::error::{Error, Result};
use crate::named::unknown;
use crate::springs::distance;
use crate::symbolic::Predicate;
use std::collections::HashSet;

/// A part of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum Selection {
    /// The points, sides and cells of the group with this name.
    Group(String),
    /// The points whose coordinates x, y (, z) in m satisfy the condition, the boundary sides with all points selected, and the cells whose middle
    /// satisfies it. A mesh on which the condition was chosen before its cells were divided has the same part, see [`Mesh::choose`].
    Where(Predicate),
    /// All points, boundary sides and cells.
    Everything,
}

impl Selection {
    /// The selected points, ascending.
    ///
    /// # Errors
    /// There is no such group.
    pub fn points(&self, mesh: &Mesh) -> Result<Vec<usize>> {
        Ok(match self {
            Selection::Group(name) => group(mesh, name)?.points.clone(),
            Selection::Where(condition) => match mesh.conditions.iter().find(|chosen| chosen.condition == *condition) {
                Some(chosen) => chosen.points.clone(),
                None => (0..mesh.node_count()).filter(|&p| condition.holds(mesh.point(p))).collect(),
            },
            Selection::Everything => (0..mesh.node_count()).collect(),
        })
    }

    /// The selected sides: those that the mesh lists in the group; or, if it lists none, and of a condition, those on the boundary with all points selected.
    ///
    /// # Errors
    /// There is no such group, or it lists sides that no cell has: a load on the others alone would be too small.
    pub fn sides(&self, mesh: &Mesh) -> Result<Vec<SideIndex>> {
        match self {
            Selection::Group(name) if !group(mesh, name)?.sides.is_empty() => {
                let ListedSides { sides, lost } = ListedSides::of(mesh, group(mesh, name)?);
                let Some(first) = lost.first() else { return Ok(sides) };
                let expected = format!("sides of cells in group \"{name}\"");
                let nodes = first.iter().map(|&p| mesh.point_number(p).to_string()).collect::<Vec<_>>().join(", ");
                let first = match first.is_empty() {
                    true => "with nodes that belong to no cell".into(),
                    false => format!("with the {}s {nodes}", mesh.point_word()),
                };
                let found =
                    format!("{} of {} that no cell has, the first {first}", lost.len(), lost.len() + sides.len());
                Err(Error::expected("group", expected, found))
            }
            Selection::Group(_) | Selection::Where(_) | Selection::Everything => {
                Ok(outer_sides(mesh, &is_selected(mesh, &self.points(mesh)?)))
            }
        }
    }

    /// The selected cells.
    ///
    /// # Errors
    /// There is no such group.
    pub fn cells(&self, mesh: &Mesh) -> Result<Vec<CellIndex>> {
        match self {
            Selection::Group(name) => Ok(group(mesh, name)?.cells.clone()),
            Selection::Where(condition) => {
                let chosen = mesh.conditions.iter().find(|chosen| chosen.condition == *condition);
                Ok(match chosen.and_then(|chosen| chosen.cells.as_ref()) {
                    Some(cells) => cells.clone(),
                    None => mesh.cell_indices().filter(|cell| condition.holds(&mesh.middle(*cell))).collect(),
                })
            }
            Selection::Everything => Ok(mesh.cell_indices().collect()),
        }
    }
}

impl Mesh {
    /// Whether each point is on a side on the boundary, `[points]`.
    pub fn outer_points(&self) -> Vec<bool> {
        let mut is_outer = vec![false; self.point_count()];
        let sides = outer_sides(self, &vec![true; self.point_count()]);
        sides.iter().flat_map(|side| self.side_points(side)).for_each(|p| is_outer[p] = true);
        is_outer
    }

    /// About how many cells the body is thick where it is thickest, by the layers of points between its sides; `None` from `most` on.
    pub fn cells_across(&self, most: usize) -> Option<usize> {
        let mut depth: Vec<usize> =
            self.outer_points().iter().map(|outer| if *outer { 0 } else { usize::MAX }).collect();
        let cells: Vec<&[usize]> = self.body_blocks().flat_map(|(_, block)| block.cells()).collect();
        let mut deepest = 0;
        loop {
            let next: Vec<usize> = cells
                .iter()
                .filter(|cell| cell.iter().any(|&p| depth[p] == deepest))
                .flat_map(|cell| cell.iter().copied().filter(|&p| depth[p] == usize::MAX))
                .collect();
            if next.is_empty() {
                break;
            }
            deepest += 1;
            if 2 * deepest >= most {
                return None;
            }
            next.into_iter().for_each(|p| depth[p] = deepest);
        }
        // An odd number has a layer of cells in its middle.
        let middle = cells.iter().filter(|cell| cell.iter().all(|&p| depth[p] == deepest)).count();
        let is_odd = deepest == 0 || 10 * middle >= cells.len();
        Some(2 * deepest + usize::from(is_odd))
    }

    /// The number of cells of the body whose longest edge is so many times as long as their shortest, or more.
    pub fn long_cells(&self, times: f64) -> usize {
        let of_block = |block: &CellBlock| {
            let corner = |c: usize| block.element.corner_node(c);
            let edges: Vec<[usize; 2]> =
                block.element.cell.edges().iter().filter_map(|[a, b]| Some([corner(*a)?, corner(*b)?])).collect();
            let is_long = |nodes: &&[usize]| {
                let length = |[a, b]: &[usize; 2]| distance(self.point(nodes[*a]), self.point(nodes[*b]));
                let ends = |[least, most]: [f64; 2], length: f64| [least.min(length), most.max(length)];
                let [least, most] = edges.iter().map(length).fold([f64::INFINITY, 0.0], ends);
                most >= times * least
            };
            block.cells().filter(is_long).count()
        };
        self.body_blocks().map(|(_, block)| of_block(block)).sum()
    }

    /// Chooses what conditions select, on this mesh and on all into which its cells are divided: a point of a divided cell is selected where
    /// all points whose shape functions do not vanish there are, and the parts of a selected cell are. What is held, loaded or of one material is
    /// therefore the same part of the body on every mesh, whatever the condition says between the points of this one. Each condition comes with
    /// whether cells are asked for.
    pub fn choose(&mut self, conditions: impl IntoIterator<Item = (Predicate, bool)>) {
        for (condition, asks_cells) in conditions {
            let selection = Selection::Where(condition.clone());
            let known = "a condition is no group that may be missing";
            let points = selection.points(self).expect(known);
            let cells = asks_cells.then(|| selection.cells(self).expect(known));
            match self.conditions.iter_mut().find(|chosen| chosen.condition == condition) {
                Some(chosen) => chosen.cells = chosen.cells.take().or(cells),
                None => self.conditions.push(Chosen { condition, points, cells }),
            }
        }
    }

    /// Takes what conditions select over from a coarser mesh of the same body, in whose cells the points of this one have these places.
    ///
    /// # Errors
    /// The middle of a cell is far from all cells of the coarser mesh.
    pub fn choose_as_on(&mut self, coarse: &Mesh, places: &Embedding) -> Result<()> {
        let asks_cells = coarse.conditions.iter().any(|chosen| chosen.cells.is_some());
        let middles: Vec<f64> = match asks_cells {
            true => self.cell_indices().flat_map(|cell| self.middle(cell)).collect(),
            false => Vec::new(),
        };
        let of_middles = Embedding::of(&middles, coarse)?.cells;
        let taken = |Chosen { condition, points, cells }: &Chosen| {
            let points = places.carried_by(&is_selected(coarse, points));
            let cells = cells.as_ref().map(|cells| {
                let cells: HashSet<CellIndex> = cells.iter().copied().collect();
                let pairs = self.cell_indices().zip(&of_middles);
                pairs.filter(|(_, of)| cells.contains(*of)).map(|(cell, _)| cell).collect()
            });
            Chosen { condition: condition.clone(), points, cells }
        };
        self.conditions = coarse.conditions.iter().map(taken).collect();
        Ok(())
    }
}

/// The sides that a group lists, compared with those of the cells.
pub struct ListedSides {
    /// Those that a cell has, each once.
    pub sides: Vec<SideIndex>,
    /// The points of those that no cell has, without the points that belong to no cell.
    pub lost: Vec<Vec<usize>>,
}

impl ListedSides {
    /// Those of a group of the mesh.
    pub fn of(mesh: &Mesh, group: &Group) -> ListedSides {
        if group.sides.is_empty() {
            return ListedSides { sides: Vec::new(), lost: Vec::new() };
        }
        // Sides whose points belong to no cell are empty: they are counted one by one.
        let (mut listed, mut lost): (Vec<_>, Vec<_>) = group.sides.iter().cloned().partition(|side| !side.is_empty());
        listed.sort_unstable();
        listed.dedup();
        let mut found = vec![None; listed.len()];
        let is_of_listed = is_selected(mesh, &listed.concat());
        for side in mesh.side_indices().filter(|side| mesh.side_points(side).all(|p| is_of_listed[p])) {
            if let Ok(place) = listed.binary_search(&sorted(&mesh.side_nodes(&side))) {
                found[place].get_or_insert(side);
            }
        }
        let known = listed.into_iter().zip(&found).filter(|(_, side)| side.is_none());
        lost.splice(0..0, known.map(|(points, _)| points));
        ListedSides { sides: found.into_iter().flatten().collect(), lost }
    }
}

/// Whether each point of the mesh is among these.
pub(super) fn is_selected(mesh: &Mesh, points: &[usize]) -> Vec<bool> {
    let mut is_selected = vec![false; mesh.point_count()];
    points.iter().for_each(|&p| is_selected[p] = true);
    is_selected
}

/// The sides on the boundary with all points selected.
pub(super) fn outer_sides(mesh: &Mesh, is_selected: &[bool]) -> Vec<SideIndex> {
    // A side of one cell is on the boundary.
    let mut outer = Vec::new();
    mesh.each_side_set(|sides| {
        if let [side] = sides {
            outer.extend(mesh.side_points(side).all(|p| is_selected[p]).then_some(*side));
        }
    });
    // Sides come in the order of their lowest points, and are listed in that of the cells.
    outer.sort_unstable_by_key(|side| (side.cell.block, side.cell.cell, side.side));
    outer
}

/// The cells with all points selected.
pub(super) fn whole_cells(mesh: &Mesh, is_selected: &[bool]) -> Vec<CellIndex> {
    mesh.cell_indices().filter(|cell| mesh.cell_nodes(*cell).iter().all(|&p| is_selected[p])).collect()
}

pub(super) fn group<'a>(mesh: &'a Mesh, name: &str) -> Result<&'a Group> {
    mesh.groups.get(name).ok_or_else(|| {
        let known: Vec<_> = mesh.groups.keys().map(|g| format!("\"{g}\"")).collect();
        let expected = match known.as_slice() {
            [] => "a condition in \"where\", for this mesh has no groups".to_string(),
            _ => format!("a group of the mesh: {}", known.join(", ")),
        };
        unknown(expected, mesh.groups.keys().map(String::as_str), name).at_key("group")
    })
}
