//! What a mesh file says, before any element definition has been asked.

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
    /// Of the points in the file, `[points]`: tags in Gmsh's formats, places from 0 in VTK's. Empty where there is no file.
    pub numbers: Vec<u64>,
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
