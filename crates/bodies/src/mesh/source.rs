//! What a mesh file says, before any element definition has been asked.

use crate::error::{Error, Result};
use std::path::Path;

/// The numbering of cell types a file uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Gmsh,
    Vtk,
}

/// Points and typed cells as they stand in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSource {
    pub format: Format,
    /// Coordinates in mesh units; always three.
    pub points: Vec<[f64; 3]>,
    pub blocks: Vec<SourceBlock>,
}

/// Cells of one type that belong to the same groups.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceBlock {
    /// 0 for points, 1 for curves, 2 for surfaces, 3 for solids.
    pub dimension: usize,
    /// The number of the cell type in the file's `format`.
    pub cell_type: u32,
    pub nodes_per_cell: usize,
    /// Indices into `points`, cell after cell, in the file's node order.
    pub connectivity: Vec<usize>,
    /// Names of the groups that hold all cells of this block.
    pub groups: Vec<String>,
}

impl MeshSource {
    /// Reads `.msh`, `.vtu` or `.vtk`, told apart by the ending.
    ///
    /// # Errors
    /// The file is missing, of another kind, damaged or cut short, or has a coordinate that is not finite.
    pub fn read(path: &Path) -> Result<MeshSource> {
        let bytes = crate::file::read(path)?;
        MeshSource::parse(&bytes, &crate::file::ending(path)).map_err(|e| e.in_file(path))
    }

    /// Reads the content of a file with this ending: `msh`, `vtu` or `vtk`.
    ///
    /// # Errors
    /// Those of [`MeshSource::read`].
    pub fn parse(bytes: &[u8], ending: &str) -> Result<MeshSource> {
        let source = match ending {
            "msh" => super::gmsh::parse(bytes),
            "vtu" | "vtk" => super::vtk::parse(bytes, ending),
            _ => Err(Error::new("expected a mesh ending in .msh, .vtu or .vtk")),
        };
        source.and_then(MeshSource::checked)
    }

    fn checked(self) -> Result<MeshSource> {
        if let Some(i) = self.points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            let [x, y, z] = self.points[i];
            return Err(Error::expected(format!("node {}", i + 1), "finite coordinates", format!("({x}, {y}, {z})")));
        }
        for block in &self.blocks {
            if let Some(&i) = block.connectivity.iter().find(|&&i| i >= self.points.len()) {
                return Err(Error::expected("cells", format!("node indices below {}", self.points.len()), i));
            }
        }
        Ok(self)
    }
}
