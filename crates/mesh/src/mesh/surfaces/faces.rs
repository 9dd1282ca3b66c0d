//! Triangles and quadrangles in groups, as files of surfaces list them.

use crate::mesh::annotations::Annotations;
use crate::mesh::coincident::Coincident;
use crate::mesh::grouping::Gather;
use crate::mesh::numbering::NumberOrigin;
use crate::mesh::polygons::triangles;
use crate::mesh::polytope::CellType;
use crate::mesh::source::{Format, MeshSource};
use crate::springs::{cross, dot, norm};
use std::collections::HashSet;

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

    /// The mesh of these faces; the numbers of the points count from `first`. What has no area, and what is there again, is no part of the surface.
    pub fn into_source(self, points: Vec<[f64; 3]>, first: u64) -> MeshSource {
        let mut annotations = Annotations::default();
        if self.divided[0] > 0 {
            let [faces, parts] = self.divided;
            let faces = if faces == 1 { "1 face".to_string() } else { format!("{faces} faces") };
            annotations.remark(format!("{faces} of more than four corners: {parts} triangles here"));
        }
        let mut places = Coincident::default();
        let places: Vec<usize> = points.iter().map(|&point| places.index(point)).collect();
        let [mut without_area, mut again] = [0, 0];
        let blocks = self.gather.into_lists().map(|((cell_type, groups), list)| {
            let list = if cell_type.dimension() == 2 {
                let kept = without_idle(cell_type.nodes(), list, &points, &places);
                without_area += kept.without_area;
                again += kept.again;
                kept.list
            } else {
                list
            };
            cell_type.block(list, groups)
        });
        let blocks = blocks.collect();
        for (count, what) in
            [(without_area, "without area"), (again, "with the corners of an earlier one in the same order")]
        {
            if count > 0 {
                let faces = if count == 1 { "face" } else { "faces" };
                annotations.remark(format!("{count} {faces} {what} left out"));
            }
        }
        let numbers = (first..first + points.len() as u64).collect();
        let origin = if first == 0 { NumberOrigin::FilePlace } else { NumberOrigin::NodeNumber };
        MeshSource { format: Format::Vtk, origin, points, numbers, blocks, space: Some(3), annotations }
    }
}

/// Faces that are part of a surface, and how many others there were.
struct Kept {
    list: Vec<usize>,
    without_area: usize,
    again: usize,
}

/// The faces without those that have no area, and without those that have the corners of an earlier one in the same order: what a surface encloses is the
/// same without them. One that is there again the other way round is the second side of something.
fn without_idle(nodes: usize, list: Vec<usize>, points: &[[f64; 3]], places: &[usize]) -> Kept {
    let mut met = HashSet::with_capacity(list.len() / nodes);
    let mut kept = Kept { list: Vec::with_capacity(list.len()), without_area: 0, again: 0 };
    for face in list.chunks_exact(nodes) {
        let mut corners = [usize::MAX; 4];
        corners.iter_mut().zip(face).for_each(|(corner, &node)| *corner = places[node]);
        let least = (0..nodes).min_by_key(|&k| corners[k]).unwrap_or(0);
        corners[..nodes].rotate_left(least);
        if !has_area(face, points) {
            kept.without_area += 1;
        } else if met.insert(corners) {
            kept.list.extend_from_slice(face);
        } else {
            kept.again += 1;
        }
    }
    if kept.list.is_empty() {
        // A file of such faces alone is refused by what it has.
        return Kept { list, without_area: 0, again: 0 };
    }
    kept
}

/// Whether the corners of a triangle are not on one line; other faces are judged with the cells.
fn has_area(face: &[usize], points: &[[f64; 3]]) -> bool {
    let &[a, b, c] = face else { return true };
    let from = |p: usize, q: usize| -> [f64; 3] { std::array::from_fn(|k| points[q][k] - points[p][k]) };
    let (u, v, w) = (from(a, b), from(a, c), from(b, c));
    let longest = [u, v, w].iter().map(|side| dot(side, side)).fold(0.0, f64::max);
    norm(&cross(u, v)) > 4.0 * f64::EPSILON * longest
}
