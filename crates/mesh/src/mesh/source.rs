//! The content of a mesh file, before its cells have elements.

use super::annotations::Annotations;
use super::grouping::Run;
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
    /// The dimension of the space, if the kind of file says it: a surface of triangles is in space, also where it is flat. Otherwise bodies of
    /// fewer than three dimensions with equal z are in the plane.
    pub space: Option<usize>,
    /// What else the file says.
    pub annotations: Annotations,
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
    /// Whether cells of fewer dimensions than the body mark its sides, edges and points by their groups; or else they are bodies themselves.
    pub is_marker: bool,
    /// The runs of cells between which the source has cells of other blocks; empty if that is not known.
    pub runs: Vec<Run>,
}

impl SourceBlock {
    /// Whether the cells are polygons, which no cell has as sides.
    pub(super) fn is_of_polygons(&self) -> bool {
        self.dimension == 2 && ![3, 6, 7, 10, 4, 8, 9, 16].contains(&self.nodes_per_cell)
    }

    /// What one of the cells is, in words, with the groups that it is in.
    pub(super) fn title(&self) -> String {
        let shape = match (self.dimension, self.nodes_per_cell) {
            (0, _) => "point",
            (1, _) => "line",
            (2, _) if self.is_of_polygons() => "polygon",
            (2, 3 | 6 | 7 | 10) => "triangle",
            (2, _) => "quadrangle",
            _ => "solid cell",
        };
        match &self.groups[..] {
            [] => shape.to_string(),
            groups => format!("{shape} of {}", groups.join(" and ")),
        }
    }
}
