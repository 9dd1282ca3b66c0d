//! The regions of a body: cells that belong to the same physical groups and to the same part of the material.

use crate::material::MaterialMap;
use crate::mesh::{CellIndex, Mesh};
use std::collections::BTreeMap;

/// The region of each cell.
#[derive(Debug, Clone)]
pub struct BodyRegions {
    /// The physical groups and the part of the material that make each region.
    names: Vec<Vec<String>>,
    /// By block, `[cells]`.
    cells: Vec<Vec<usize>>,
}

impl BodyRegions {
    /// The regions of a mesh. A part of the material that is named like a group of the cell is that group.
    pub fn of(mesh: &Mesh, material: &MaterialMap) -> BodyRegions {
        let (mut known, mut names) = (BTreeMap::new(), Vec::new());
        let cells = mesh.regions().into_iter().enumerate().map(|(block, groups)| {
            let region = |(cell, mut own): (usize, Vec<&str>)| {
                let part = material.regions()[*material.region().at(block, cell)].as_str();
                // A material without regions has one part, without a name.
                if !part.is_empty() && !own.contains(&part) {
                    own.push(part);
                }
                let own: Vec<String> = own.into_iter().map(String::from).collect();
                *known.entry(own.clone()).or_insert_with(|| {
                    names.push(own);
                    names.len() - 1
                })
            };
            groups.into_iter().enumerate().map(region).collect()
        });
        let cells = cells.collect();
        BodyRegions { names, cells }
    }

    /// The names that make the region of a cell.
    pub fn names(&self, CellIndex { block, cell }: CellIndex) -> &[String] {
        &self.names[self.cells[block][cell]]
    }
}
