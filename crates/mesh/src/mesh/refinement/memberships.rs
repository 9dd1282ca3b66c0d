//! The groups to which the cells, sides and edges of a mesh belong.

use super::super::mesh::{CellIndex, Group, Mesh};
use crate::error::{Error, Result};
use std::collections::{BTreeMap, HashMap};

/// The groups of a mesh by their members, and the growing groups of the divided mesh.
pub struct Memberships<'a> {
    names: Vec<&'a String>,
    cells: HashMap<CellIndex, Vec<usize>>,
    sides: HashMap<Vec<usize>, Vec<usize>>,
    edges: HashMap<Vec<usize>, Vec<usize>>,
    /// Those of `sides` and `edges` that a cell has.
    met: [std::collections::HashSet<Vec<usize>>; 2],
    groups: Vec<Group>,
    leads: Vec<Lead>,
}

/// The part of a group of which its points are: that of the lowest dimension.
#[derive(Clone, Copy, PartialEq)]
enum Lead {
    Points,
    Edges,
    Sides,
    Cells,
}

impl<'a> Memberships<'a> {
    pub fn of(mesh: &'a Mesh) -> Memberships<'a> {
        let mut all = Memberships {
            names: mesh.groups.keys().collect(),
            cells: HashMap::new(),
            sides: HashMap::new(),
            edges: HashMap::new(),
            met: Default::default(),
            groups: Vec::new(),
            leads: Vec::new(),
        };
        for (index, group) in mesh.groups.values().enumerate() {
            group.cells.iter().for_each(|&cell| all.cells.entry(cell).or_default().push(index));
            group.sides.iter().for_each(|side| all.sides.entry(side.clone()).or_default().push(index));
            group.edges.iter().for_each(|edge| all.edges.entry(edge.clone()).or_default().push(index));
            let Group { points, lists_points, .. } = group;
            all.leads.push(match group {
                _ if group.is_of_points() => Lead::Points,
                Group { edges, .. } if !edges.is_empty() => Lead::Edges,
                Group { sides, .. } if !sides.is_empty() => Lead::Sides,
                _ => Lead::Cells,
            });
            all.groups.push(Group { points: points.clone(), lists_points: *lists_points, ..Group::default() });
        }
        all
    }

    /// Adds the parts of a cell, with their points, to its groups.
    pub fn divide_cell(&mut self, cell: CellIndex, parts: &[CellIndex], points: &[usize]) {
        for &group in self.cells.get(&cell).into_iter().flatten() {
            self.groups[group].cells.extend(parts);
            if self.leads[group] == Lead::Cells {
                self.groups[group].points.extend(points);
            }
        }
    }

    /// Adds the parts of the side with these points to its groups.
    pub fn divide_side(&mut self, side: Vec<usize>, parts: impl Iterator<Item = Vec<usize>> + Clone) {
        for &group in self.sides.get(&side).into_iter().flatten() {
            if self.leads[group] == Lead::Sides {
                self.groups[group].points.extend(parts.clone().flatten());
            }
            self.groups[group].sides.extend(parts.clone());
        }
        if self.sides.contains_key(&side) {
            self.met[0].insert(side);
        }
    }

    /// Adds the parts of the edge with these points to its groups.
    pub fn divide_edge(&mut self, edge: Vec<usize>, parts: impl Iterator<Item = Vec<usize>> + Clone) {
        for &group in self.edges.get(&edge).into_iter().flatten() {
            if self.leads[group] == Lead::Edges {
                self.groups[group].points.extend(parts.clone().flatten());
            }
            self.groups[group].edges.extend(parts.clone());
        }
        if self.edges.contains_key(&edge) {
            self.met[1].insert(edge);
        }
    }

    /// Whether any group has sides.
    pub fn has_sides(&self) -> bool {
        !self.sides.is_empty()
    }

    /// Whether any group has edges.
    pub fn has_edges(&self) -> bool {
        !self.edges.is_empty()
    }

    /// The groups of the divided mesh.
    ///
    /// # Errors
    /// A group has a side or an edge that no cell has, so that it has no parts.
    pub fn into_groups(self) -> Result<BTreeMap<String, Group>> {
        for (what, listed, met) in [("sides", &self.sides, &self.met[0]), ("edges", &self.edges, &self.met[1])] {
            let lost: Vec<_> = listed.iter().filter(|(points, _)| !met.contains(*points)).collect();
            if let Some(group) = lost.iter().flat_map(|(_, groups)| groups.iter()).min() {
                let count = lost.iter().filter(|(_, groups)| groups.contains(group)).count();
                let expected = format!("{what} of cells in group \"{}\"", self.names[*group]);
                return Err(Error::expected("mesh", expected, format!("{count} {what} that no cell has")));
            }
        }
        let sorted = |mut group: Group| {
            // Parents that share a point have both added it.
            group.points.sort_unstable();
            group.points.dedup();
            for parts in [&mut group.sides, &mut group.edges] {
                parts.sort_unstable();
                parts.dedup();
            }
            group
        };
        Ok(self.names.into_iter().cloned().zip(self.groups.into_iter().map(sorted)).collect())
    }
}
