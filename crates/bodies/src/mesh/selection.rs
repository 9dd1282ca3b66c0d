//! Parts of a mesh, selected by group name or by a condition on the coordinates.

use super::mesh::{CellIndex, Group, Mesh, SideIndex, sorted};
use crate::error::Result;
use crate::named::unknown;
use crate::symbolic::Predicate;
use std::collections::HashMap;

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
        let points = self.points(mesh)?;
        // How often each side occurs, and where first: a side that occurs once is on the boundary.
        let mut met: HashMap<Vec<usize>, (usize, SideIndex)> = HashMap::new();
        let mut order = Vec::new();
        for (block, cells) in mesh.blocks.iter().enumerate() {
            for (cell, nodes) in cells.cells().enumerate() {
                for (side, table) in cells.element.sides().iter().enumerate() {
                    let inside = |&a: &usize| points.binary_search(&nodes[a]).is_ok();
                    if !table.nodes.iter().all(inside) {
                        continue;
                    }
                    let key = sorted(&table.nodes.iter().map(|&a| nodes[a]).collect::<Vec<_>>());
                    let index = SideIndex { cell: CellIndex { block, cell }, side };
                    met.entry(key.clone()).and_modify(|(count, _)| *count += 1).or_insert_with(|| {
                        order.push(key);
                        (1, index)
                    });
                }
            }
        }
        Ok(match self {
            Selection::Group(name) => {
                let mut listed = group(mesh, name)?.sides.clone();
                listed.sort_unstable();
                listed.dedup();
                listed.iter().filter_map(|key| met.get(key)).map(|(_, index)| *index).collect()
            }
            Selection::Where(_) | Selection::Everything => {
                order.iter().map(|key| met[key]).filter(|(count, _)| *count == 1).map(|(_, index)| index).collect()
            }
        })
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
