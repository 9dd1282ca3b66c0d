//! Voxels as cells of another shape.

use super::boxes::parts;
use super::grouping::Run;
use super::mesh::Mesh;
use super::polytope::CellType;
use super::source::{Format, MeshSource, SourceBlock};
use crate::element::{Cell, Element};
use crate::error::{Error, ErrorKind, Result};
use crate::springs::{cross, dot, norm};
use std::sync::Arc;

/// Voxels, or other boxes whose edges run along the same three directions, as cells of another shape.
///
/// Each is divided into six tetrahedra along its main diagonal, as the cells of a [`BoxMesh`](super::BoxMesh) are, so that neighbours agree on their
/// sides. The points and the groups are those of the voxels.
#[derive(Debug, Clone)]
pub struct VoxelMesh {
    /// The element of all cells: a tetrahedron with corners alone, or a hexahedron, which leaves the voxels as they are.
    pub element: Arc<Element>,
}

/// The corners of a hexahedron of VTK in the unit cube.
const CORNERS: [[u8; 3]; 8] = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
/// A part of an edge by which a corner may be beside its place: coordinates in single precision are rounded by less.
const BESIDE: f64 = 1e-4;

impl MeshSource {
    /// Whether its cells are solid, and no surface that encloses a solid.
    pub fn is_solid(&self) -> bool {
        self.blocks.iter().any(|block| block.dimension == 3)
    }
}

impl VoxelMesh {
    /// The mesh of the voxels in `source`, with `scale` metres per unit.
    ///
    /// # Errors
    /// The cells are no voxels, or the element has other cells or nodes.
    pub fn build(&self, source: &MeshSource, scale: f64) -> Result<Mesh> {
        let serves = |cell_type: CellType| {
            let vtk = self.element.formats.vtk.as_ref();
            vtk.is_some_and(|entry| entry.cell_type == u32::from(cell_type.0))
        };
        let own = [self.element.clone()];
        let mut divided = source.clone();
        for block in divided.blocks.iter_mut().filter(|block| block.dimension == 3) {
            check(source, block)?;
        }
        match self.element.cell {
            Cell::Hexahedron if serves(CellType::HEX8) => return Mesh::resolve(source, &own, scale),
            Cell::Tetrahedron if serves(CellType::TET4) => {}
            _ => {
                let expected = "an element of tetrahedra or hexahedra with corners alone, for voxels";
                return Err(Error::expected("element", expected, &self.element.name).of_kind(ErrorKind::Unsupported));
            }
        }
        // The corners of the voxel at the corners of each part, with the normals of a part outwards in a cube of positive volume.
        let place = |at: Vec<f64>| CORNERS.iter().position(|c| (0..3).all(|k| (f64::from(c[k]) - at[k]).abs() < 0.5));
        let of_part = |part: super::affine::Affine| -> Option<[usize; 4]> {
            let corners: Option<Vec<usize>> =
                self.element.cell.corners().iter().map(|c| place(part.place(c))).collect();
            let [a, b, c, d]: [usize; 4] = corners?.try_into().ok()?;
            let edge = |k: usize| [part.edges[k][0], part.edges[k][1], part.edges[k][2]];
            Some(if dot(&cross(edge(0), edge(1)), &edge(2)) > 0.0 { [a, b, c, d] } else { [a, c, b, d] })
        };
        let parts: Vec<[usize; 4]> = parts(self.element.cell).into_iter().filter_map(of_part).collect();
        for block in divided.blocks.iter_mut().filter(|block| block.dimension == 3) {
            let mut connectivity = Vec::with_capacity(3 * block.connectivity.len());
            for nodes in block.connectivity.chunks_exact(block.nodes_per_cell) {
                let [e, f, g] = edges(source, nodes);
                let is_mirrored = dot(&cross(e, f), &g) < 0.0;
                for [a, b, c, d] in &parts {
                    let [b, c] = if is_mirrored { [c, b] } else { [b, c] };
                    connectivity.extend([a, b, c, d].map(|&corner| nodes[corner]));
                }
            }
            let groups = std::mem::take(&mut block.groups);
            let is_marker = block.is_marker;
            let per_voxel = 4 * parts.len();
            let run = |run: &Run| Run { start: run.start / block.nodes_per_cell * per_voxel, ..*run };
            let runs = block.runs.iter().map(run).collect();
            *block = SourceBlock { is_marker, runs, ..CellType::TET4.cells(connectivity, groups) };
        }
        Mesh::resolve(&divided, &own, scale)
    }
}

/// The edges of a hexahedron from its first corner.
fn edges(source: &MeshSource, nodes: &[usize]) -> [[f64; 3]; 3] {
    let [o, x, y, z] = [0, 1, 3, 4].map(|corner| source.points[nodes[corner]]);
    [x, y, z].map(|end| std::array::from_fn(|k| end[k] - o[k]))
}

/// That the cells of a block are boxes whose edges run along those of the first.
fn check(source: &MeshSource, block: &SourceBlock) -> Result<()> {
    let wrong = |found: String| Err(Error::expected("surface", "a closed surface, or voxels of an image", found));
    if source.format != Format::Vtk || block.cell_type != u32::from(CellType::HEX8.0) {
        return wrong(format!("solid cells with {} nodes", block.nodes_per_cell));
    }
    let Some(first) = source.blocks.iter().find(|block| block.dimension == 3) else { return Ok(()) };
    let along = edges(source, &first.connectivity[..first.nodes_per_cell]);
    for (number, nodes) in block.connectivity.chunks_exact(block.nodes_per_cell).enumerate() {
        let own = edges(source, nodes);
        let is_along = (0..3).all(|k| {
            let (a, b) = (norm(&own[k]), norm(&along[k]));
            dot(&own[k], &along[k]) > 0.0 && norm(&cross(own[k], along[k])) <= BESIDE * a * b
        });
        let size = own.iter().map(|edge| norm(edge)).fold(0.0, f64::max);
        let is_box = CORNERS.iter().zip(nodes).all(|(corner, &node)| {
            (0..3).all(|axis| {
                let expected =
                    (0..3).fold(source.points[nodes[0]][axis], |x, k| x + f64::from(corner[k]) * own[k][axis]);
                (source.points[node][axis] - expected).abs() <= BESIDE * size
            })
        });
        if !(is_along && is_box) {
            return wrong(format!("hexahedra of which cell {} does not run along the first", number + 1));
        }
    }
    Ok(())
}
