//! Triangles and quadrangles in groups, as files of surfaces list them.

use crate::mesh::annotations::Annotations;
use crate::mesh::grouping::{Gather, Gathered};
use crate::mesh::numbering::NumberOrigin;
use crate::mesh::polygons::triangles;
use crate::mesh::polytope::CellType;
use crate::mesh::source::{Format, MeshSource, SourceBlock};

pub(super) struct Faces {
    gather: Gather<(CellType, Vec<String>)>,
    key: (CellType, Vec<String>),
    /// How many faces of more than four corners there were, and how many triangles they are.
    divided: [usize; 2],
}

/// The end of an error on a face that is not taken.
pub(super) const TRIANGULATE: &str =
    "flat faces of three corners or more whose sides do not cross (a modelling program triangulates others)";

impl Faces {
    pub fn new() -> Self {
        Faces { gather: Gather::new(), key: (CellType::POINT, Vec::new()), divided: [0; 2] }
    }

    /// The groups of the faces that follow.
    pub fn enter(&mut self, groups: Vec<String>) {
        self.key.1 = groups;
    }

    /// Adds a line, a triangle, a quadrangle, or the triangles of a polygon; `false` for a face that has none.
    pub fn push(&mut self, nodes: &[usize], points: &[[f64; 3]]) -> bool {
        self.key.0 = match nodes.len() {
            2 => CellType::LINE2,
            3 => CellType::TRI3,
            4 => CellType::QUAD4,
            _ => {
                let corners: Vec<[f64; 3]> = nodes.iter().map(|&node| points[node]).collect();
                let Some(parts) = triangles(&corners) else { return false };
                self.key.0 = CellType::TRI3;
                self.divided = [self.divided[0] + 1, self.divided[1] + parts.len()];
                self.gather.list(&self.key).extend(parts.into_iter().flatten().map(|place| nodes[place]));
                return true;
            }
        };
        self.gather.list(&self.key).extend_from_slice(nodes);
        true
    }

    /// The mesh of these faces; the numbers of the points count from `first`.
    pub fn into_source(self, points: Vec<[f64; 3]>, first: u64) -> MeshSource {
        let mut annotations = Annotations::default();
        if self.divided[0] > 0 {
            let [faces, parts] = self.divided;
            let faces = if faces == 1 { "1 face".to_string() } else { format!("{faces} faces") };
            annotations.remark(format!("{faces} of more than four corners: {parts} triangles here"));
        }
        let block = |Gathered { key: (cell_type, groups), nodes, runs }: Gathered<(CellType, Vec<String>)>| {
            SourceBlock { runs, ..cell_type.block(nodes, groups) }
        };
        let blocks = self.gather.into_lists().map(block).collect();
        let numbers = (first..first + points.len() as u64).collect();
        let origin = if first == 0 { NumberOrigin::FilePlace } else { NumberOrigin::NodeNumber };
        MeshSource { format: Format::Vtk, origin, points, numbers, blocks, space: Some(3), annotations }
    }
}
