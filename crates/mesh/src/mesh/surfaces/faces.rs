//! Triangles and quadrangles in groups, as files of surfaces list them.

use crate::mesh::annotations::Annotations;
use crate::mesh::grouping::Gather;
use crate::mesh::numbering::NumberOrigin;
use crate::mesh::polytope::CellType;
use crate::mesh::source::{Format, MeshSource};

pub(super) struct Faces {
    gather: Gather<(CellType, Vec<String>)>,
    key: (CellType, Vec<String>),
}

/// The end of an error on a face with more corners.
pub(super) const TRIANGULATE: &str = "triangles or quadrangles (a modelling program triangulates the others)";

impl Faces {
    pub fn new() -> Self {
        Faces { gather: Gather::new(), key: (CellType::POINT, Vec::new()) }
    }

    /// The groups of the faces that follow.
    pub fn enter(&mut self, groups: Vec<String>) {
        self.key.1 = groups;
    }

    /// Adds a line, a triangle or a quadrangle; `false` for a face with another number of corners.
    pub fn push(&mut self, nodes: &[usize]) -> bool {
        self.key.0 = match nodes.len() {
            2 => CellType::LINE2,
            3 => CellType::TRI3,
            4 => CellType::QUAD4,
            _ => return false,
        };
        self.gather.list(&self.key).extend_from_slice(nodes);
        true
    }

    /// The mesh of these faces; the numbers of the points count from `first`.
    pub fn into_source(self, points: Vec<[f64; 3]>, first: u64) -> MeshSource {
        let blocks = self.gather.into_lists().map(|((cell_type, groups), list)| cell_type.block(list, groups));
        let numbers = (first..first + points.len() as u64).collect();
        let origin = if first == 0 { NumberOrigin::FilePlace } else { NumberOrigin::NodeNumber };
        MeshSource {
            format: Format::Vtk,
            origin,
            points,
            numbers,
            blocks: blocks.collect(),
            space: Some(3),
            annotations: Annotations::default(),
        }
    }
}
