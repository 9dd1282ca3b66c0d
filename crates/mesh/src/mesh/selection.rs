//! Parts of a mesh, selected by group name or by a condition on the coordinates.

use super::embedding::Embedding;
use super::mesh::{CellIndex, Group, Mesh, SideIndex, sorted};
use crate::error::{Error, Result};
use crate::named::unknown;
use crate::symbolic::Predicate;

/// A part of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum Selection {
    /// The points, sides and cells of the group with this name.
    Group(String),
    /// The points whose coordinates x, y (, z) in m satisfy the condition, and the boundary sides and the cells with
    /// all points selected. A mesh on which the condition was chosen before its cells were divided has the same part, see [`Mesh::choose`].
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
            Selection::Where(condition) => match mesh.conditions.iter().find(|(chosen, _)| chosen == condition) {
                Some((_, points)) => points.clone(),
                None => (0..mesh.point_count()).filter(|&p| condition.holds(mesh.point(p))).collect(),
            },
            Selection::Everything => (0..mesh.point_count()).collect(),
        })
    }

    /// The selected sides: those that the mesh lists in the group, or those on the boundary with all points selected.
    ///
    /// # Errors
    /// There is no such group, or it lists sides that no cell has: a load on the others alone would be too small.
    pub fn sides(&self, mesh: &Mesh) -> Result<Vec<SideIndex>> {
        match self {
            Selection::Group(name) => {
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
            Selection::Where(_) | Selection::Everything => {
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
            Selection::Where(_) | Selection::Everything => {
                Ok(whole_cells(mesh, &is_selected(mesh, &self.points(mesh)?)))
            }
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

    /// Chooses what conditions select, on this mesh and on all into which its cells are divided: a point of a divided cell is selected where
    /// all points whose shape functions do not vanish there are. What is held, loaded or of one material is therefore the same part of the body
    /// on every mesh, whatever the condition says between the points of this one.
    pub fn choose(&mut self, conditions: impl IntoIterator<Item = Predicate>) {
        for condition in conditions {
            let selection = Selection::Where(condition.clone());
            let points = selection.points(self).expect("a condition is no group that may be missing");
            if !self.conditions.iter().any(|(chosen, _)| *chosen == condition) {
                self.conditions.push((condition, points));
            }
        }
    }

    /// Takes what conditions select over from a coarser mesh of the same body, in whose cells the points of this one have these places.
    pub fn choose_as_on(&mut self, coarse: &Mesh, places: &Embedding) {
        let taken = |(condition, points): &(Predicate, Vec<usize>)| {
            (condition.clone(), places.carried_by(&is_selected(coarse, points)))
        };
        self.conditions = coarse.conditions.iter().map(taken).collect();
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
        let is_selected = is_selected(mesh, &group.points);
        for side in mesh.side_indices().filter(|side| mesh.side_points(side).all(|p| is_selected[p])) {
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
