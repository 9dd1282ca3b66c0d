//! The content of a mesh file, before its cells have elements.

use super::numbering::NumberOrigin;

/// The numbering of cell types of a source. Readers of other formats turn their types and node orders into those of VTK.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// That of Gmsh.
    Gmsh,
    /// That of VTK.
    Vtk,
}

/// Points and typed cells as they are in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSource {
    /// The numbering of the cell types.
    pub format: Format,
    /// The meaning of the numbers of the points.
    pub origin: NumberOrigin,
    /// The coordinates in mesh units, always three.
    pub points: Vec<[f64; 3]>,
    /// The numbers of the points in the file, `[points]`. Empty if there is no file.
    pub numbers: Vec<u64>,
    /// The cells.
    pub blocks: Vec<SourceBlock>,
}

/// Cells of one type that belong to the same groups.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceBlock {
    /// The dimension: 0 for points, 1 for curves, 2 for surfaces, 3 for solids.
    pub dimension: usize,
    /// The number of the cell type in the numbering of the source.
    pub cell_type: u32,
    /// The number of nodes of each cell.
    pub nodes_per_cell: usize,
    /// Indices into `points`, cell after cell, in the node order of the file.
    pub connectivity: Vec<usize>,
    /// The names of the groups to which all cells of this block belong.
    pub groups: Vec<String>,
}
