//! Meshes and values of cells that a program has in memory, in place of files that a scene names.

use crate::error::{Error, Result};
use crate::material::CellMap;
use crate::mesh::{CellBlock, CellIndex, Embedding, Mesh};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Meshes, and values of their cells, by the names that a scene has in place of those of files.
#[derive(Debug, Clone, Default)]
pub struct InMemory {
    meshes: BTreeMap<String, Arc<Mesh>>,
    values: BTreeMap<String, Arc<CellValues>>,
}

/// Numbers of each cell of a mesh.
#[derive(Debug)]
pub struct CellValues {
    /// The mesh whose cells have the numbers; `None` for the mesh of the scene.
    pub mesh: Option<Arc<Mesh>>,
    /// Each cell has so many numbers.
    pub components: usize,
    /// `[cells × components]`, block after block.
    pub values: Vec<f64>,
}

impl InMemory {
    /// Adds a mesh, whose lengths are in metres.
    pub fn add_mesh(&mut self, name: &str, mesh: Arc<Mesh>) {
        self.meshes.insert(name.into(), mesh);
    }

    /// Adds values of cells.
    pub fn add_values(&mut self, name: &str, values: CellValues) {
        self.values.insert(name.into(), Arc::new(values));
    }

    /// The mesh of this name.
    pub(super) fn mesh(&self, name: &Path) -> Option<&Arc<Mesh>> {
        self.meshes.get(name.to_str()?)
    }

    /// The values of this name.
    pub(super) fn values(&self, name: &Path) -> Option<&Arc<CellValues>> {
        self.values.get(name.to_str()?)
    }

    /// Whether something has this name.
    pub(super) fn has(&self, name: &Path) -> bool {
        self.mesh(name).is_some() || self.values(name).is_some()
    }
}

impl CellValues {
    /// The numbers of some cells of a mesh, `[components]` each: those of the same cells, or, on a mesh into which they were divided, of the
    /// cell that the middle is in.
    ///
    /// # Errors
    /// There are others than one for each cell, a cell belongs to what is attached to the body, or the meshes are of other bodies.
    pub(super) fn of_cells(&self, mesh: &Mesh, cells: &[CellIndex], components: usize) -> Result<Vec<&[f64]>> {
        let shape = |components: usize| match components {
            1 => String::new(),
            count => format!(" of {count} numbers"),
        };
        if components != self.components {
            let expected = format!("values{} for each cell", shape(components));
            return Err(Error::new(format!("expected {expected}, found{}", shape(self.components))));
        }
        if let Some(cell) = cells.iter().find(|cell| !mesh.is_of_body(**cell)) {
            let name = &mesh.blocks[cell.block].element.name;
            let words =
                format!("expected one value for cells that are attached to the body, found an array for {name}");
            return Err(Error::new(words));
        }
        let own = self.mesh.as_deref().unwrap_or(mesh);
        let of_body = |mesh: &Mesh| mesh.body_blocks().map(|(_, block)| block.cells().len()).sum::<usize>();
        let (count, found) = (of_body(own), self.values.len() / self.components);
        if found != count {
            let hint = if self.mesh.is_none() { ", block after block" } else { "" };
            return Err(Error::new(format!(
                "expected an array of {count} values, one for each cell{hint}, found {found}"
            )));
        }
        let mut first = Vec::with_capacity(own.blocks.len());
        let mut sum = 0;
        for block in &own.blocks {
            first.push(sum);
            sum += block.cells().len();
        }
        let at = |cell: &CellIndex| {
            let place = first[cell.block] + cell.cell;
            &self.values[place * self.components..(place + 1) * self.components]
        };
        if is_same(own, mesh) {
            return Ok(cells.iter().map(at).collect());
        }
        let middles: Vec<f64> = cells.iter().flat_map(|cell| mesh.middle(*cell)).collect();
        Ok(Embedding::of(&middles, own)?.cells.iter().map(at).collect())
    }
}

impl CellValues {
    /// The numbers of all cells of a mesh without attached cells; `None` where they are of cells that were divided, or of several components.
    pub(super) fn of_mesh(&self, mesh: &Mesh) -> Option<CellMap<f64>> {
        let own = self.mesh.as_deref().unwrap_or(mesh);
        if self.components != 1 || self.values.len() != mesh.cell_count() || mesh.is_mixed() || !is_same(own, mesh) {
            return None;
        }
        let mut first = 0;
        let block = |block: &CellBlock| {
            let count = block.cells().len();
            first += count;
            self.values[first - count..first].to_vec()
        };
        Some(CellMap::of_blocks(mesh.blocks.iter().map(block).collect()))
    }
}

/// Whether the bodies of two meshes have the same cells.
fn is_same(a: &Mesh, b: &Mesh) -> bool {
    let nodes = |mesh: &Mesh| mesh.body_blocks().map(|(_, block)| block.connectivity.len()).collect::<Vec<_>>();
    std::ptr::eq(a, b)
        || (nodes(a) == nodes(b)
            && a.points == b.points
            && a.body_blocks().zip(b.body_blocks()).all(|((_, a), (_, b))| a.connectivity == b.connectivity))
}
