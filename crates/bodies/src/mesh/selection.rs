//! Parts of a mesh, selected by group name or by a condition on the coordinates.

use super::mesh::{CellIndex, Group, Mesh, SideIndex, sorted};
use crate::error::Result;
use crate::named::unknown;
use crate::symbolic::Predicate;

/// A part of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum Selection {
    /// The points, sides and cells of the group with this name.
    Group(String),
    /// The points whose coordinates x, y (, z) in m satisfy the condition, and the boundary sides and the cells with
    /// all points selected.
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
            Selection::Where(condition) => {
                (0..mesh.point_count()).filter(|&p| condition.holds(mesh.point(p))).collect()
            }
            Selection::Everything => (0..mesh.point_count()).collect(),
        })
    }

    /// The selected sides: those that the mesh lists in the group, or those on the boundary with all points selected.
    ///
    /// # Errors
    /// There is no such group.
    pub fn sides(&self, mesh: &Mesh) -> Result<Vec<SideIndex>> {
        let mut is_selected = vec![false; mesh.point_count()];
        self.points(mesh)?.into_iter().for_each(|p| is_selected[p] = true);
        let is_inside = |side: &SideIndex| mesh.side_points(side).all(|p| is_selected[p]);
        if let Selection::Group(name) = self {
            let mut listed = group(mesh, name)?.sides.clone();
            listed.sort_unstable();
            listed.dedup();
            let mut found = vec![None; listed.len()];
            for side in mesh.side_indices().filter(is_inside) {
                if let Ok(place) = listed.binary_search(&sorted(&mesh.side_nodes(&side))) {
                    found[place].get_or_insert(side);
                }
            }
            return Ok(found.into_iter().flatten().collect());
        }
        // A side of one cell is on the boundary.
        let mut outer = Vec::new();
        mesh.each_side_set(|sides| {
            if let [side] = sides {
                outer.extend(is_inside(side).then_some(*side));
            }
        });
        outer.sort_unstable_by_key(|side| (side.cell.block, side.cell.cell, side.side));
        Ok(outer)
    }

    /// The selected cells.
    ///
    /// # Errors
    /// There is no such group.
    pub fn cells(&self, mesh: &Mesh) -> Result<Vec<CellIndex>> {
        if let Selection::Group(name) = self {
            return Ok(group(mesh, name)?.cells.clone());
        }
        let points = self.points(mesh)?;
        let mut chosen = Vec::new();
        for (block, cells) in mesh.blocks.iter().enumerate() {
            for (cell, nodes) in cells.cells().enumerate() {
                if nodes.iter().all(|p| points.binary_search(p).is_ok()) {
                    chosen.push(CellIndex { block, cell });
                }
            }
        }
        Ok(chosen)
    }
}

fn group<'a>(mesh: &'a Mesh, name: &str) -> Result<&'a Group> {
    mesh.groups.get(name).ok_or_else(|| {
        let known: Vec<_> = mesh.groups.keys().map(|g| format!("\"{g}\"")).collect();
        let expected = match known.as_slice() {
            [] => "a condition in \"where\", for this mesh has no groups".to_string(),
            _ => format!("a group of the mesh: {}", known.join(", ")),
        };
        unknown(expected, mesh.groups.keys().map(String::as_str), name).at_key("group")
    })
}
