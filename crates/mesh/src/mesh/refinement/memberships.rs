//! The groups to which the cells, sides and edges of a mesh belong.

use super::super::mesh::{CellIndex, Group, Mesh};
use crate::error::{Error, Result};
use std::collections::{BTreeMap, HashMap, HashSet};

/// The groups of a mesh by their members, and the growing groups of the divided mesh.
pub struct Memberships<'a> {
    names: Vec<&'a String>,
    cells: HashMap<CellIndex, Vec<usize>>,
    /// The sides and the edges.
    listed: [Listed; 2],
    groups: Vec<Group>,
    /// The part of each group of which its points are: that of the lowest dimension.
    leads: Vec<Part>,
}

/// Sides or edges, by their points.
#[derive(Default)]
struct Listed {
    groups: HashMap<Vec<usize>, Vec<usize>>,
    /// The listed sides or edges that a cell has.
    met: HashSet<Vec<usize>>,
}

/// What a group lists. Sides and edges come first, in the order of their lists.
#[derive(Clone, Copy, PartialEq)]
pub enum Part {
    Sides,
    Edges,
    Cells,
    Points,
}

impl<'a> Memberships<'a> {
    pub fn of(mesh: &'a Mesh) -> Memberships<'a> {
        let (cells, listed, groups, leads) = Default::default();
        let mut all = Memberships { names: mesh.groups.keys().collect(), cells, listed, groups, leads };
        for (index, group) in mesh.groups.values().enumerate() {
            group.cells.iter().for_each(|&cell| all.cells.entry(cell).or_default().push(index));
            for (listed, parts) in all.listed.iter_mut().zip([&group.sides, &group.edges]) {
                parts.iter().for_each(|part| listed.groups.entry(part.clone()).or_default().push(index));
            }
            let Group { points, lists_points, .. } = group;
            all.leads.push(match group {
                _ if group.is_of_points() => Part::Points,
                Group { edges, .. } if !edges.is_empty() => Part::Edges,
                Group { sides, .. } if !sides.is_empty() => Part::Sides,
                _ => Part::Cells,
            });
            all.groups.push(Group { points: points.clone(), lists_points: *lists_points, ..Group::default() });
        }
        all
    }

    /// Adds the parts of a cell, with their points, to its groups.
    pub fn divide_cell(&mut self, cell: CellIndex, parts: &[CellIndex], points: &[usize]) {
        for &group in self.cells.get(&cell).into_iter().flatten() {
            self.groups[group].cells.extend(parts);
            if self.leads[group] == Part::Cells {
                self.groups[group].points.extend(points);
            }
        }
    }

    /// Adds the parts of the side or edge with these points to its groups.
    pub fn divide(&mut self, kind: Part, points: Vec<usize>, parts: impl Iterator<Item = Vec<usize>> + Clone) {
        let Listed { groups, met } = &mut self.listed[kind as usize];
        let Some(of_points) = groups.get(&points) else { return };
        for &index in of_points {
            let group = &mut self.groups[index];
            if self.leads[index] == kind {
                group.points.extend(parts.clone().flatten());
            }
            if kind == Part::Sides { &mut group.sides } else { &mut group.edges }.extend(parts.clone());
        }
        met.insert(points);
    }

    /// Whether any group has sides, or edges.
    pub fn has(&self, kind: Part) -> bool {
        !self.listed[kind as usize].groups.is_empty()
    }

    /// The groups of the divided mesh.
    ///
    /// # Errors
    /// A group has a side or an edge that no cell has, so that it has no parts.
    pub fn into_groups(self) -> Result<BTreeMap<String, Group>> {
        for (what, Listed { groups, met }) in ["sides", "edges"].into_iter().zip(&self.listed) {
            let lost: Vec<_> = groups.iter().filter(|(points, _)| !met.contains(*points)).collect();
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
