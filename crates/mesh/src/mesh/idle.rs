//! Faces of a surface in space that are no part of it: those without area, and those that are there again.

use super::coincident::Coincident;
use super::source::{MeshSource, SourceBlock};
use crate::springs::{cross, dot, norm};
use std::collections::HashSet;

impl MeshSource {
    /// The surface without triangles and quadrangles that have no area, and without those that have the corners of an earlier one in the same order, with a remark
    /// about each kind: what it encloses is the same. A face that is there again the other way round is the second side of something, and stays. `None` if there are no such faces, or
    /// nothing else.
    pub(super) fn without_idle_faces(&self) -> Option<MeshSource> {
        let mut places = Coincident::default();
        let places: Vec<usize> = self.points.iter().map(|&point| places.index(point)).collect();
        let is_of_faces = |block: &SourceBlock| block.dimension == 2 && (3..=4).contains(&block.nodes_per_cell);
        let faces = |block: &SourceBlock| is_of_faces(block).then(|| Kept::of(block, &self.points, &places));
        let kept: Vec<Option<Kept>> = self.blocks.iter().map(faces).collect();
        let sum = |of: fn(&Kept) -> usize| kept.iter().flatten().map(of).sum::<usize>();
        let [without_area, again] = [sum(|kept| kept.without_area), sum(|kept| kept.again)];
        if without_area + again == 0 {
            return None;
        }
        let mut source = self.clone();
        for (block, kept) in source.blocks.iter_mut().zip(kept) {
            block.connectivity = kept.map_or_else(|| std::mem::take(&mut block.connectivity), |kept| kept.list);
            // The faces that are left out have moved the others, so that runs are no longer where they were.
            block.runs.clear();
        }
        // A file of such faces alone is refused by what it has.
        if !source.blocks.iter().any(|block| block.dimension == 2 && !block.connectivity.is_empty()) {
            return None;
        }
        let kinds = [(without_area, "without area"), (again, "with the corners of an earlier one in the same order")];
        for (count, what) in kinds.into_iter().filter(|(count, _)| *count > 0) {
            let faces = if count == 1 { "face" } else { "faces" };
            source.annotations.remark(format!("{count} {faces} {what} left out"));
        }
        Some(source)
    }
}

/// The faces of a block that are part of a surface, and how many others there are.
struct Kept {
    list: Vec<usize>,
    without_area: usize,
    again: usize,
}

impl Kept {
    /// Points are at one place if these numbers of theirs are equal.
    fn of(block: &SourceBlock, points: &[[f64; 3]], places: &[usize]) -> Kept {
        let (nodes, list) = (block.nodes_per_cell, &block.connectivity);
        let mut met = HashSet::with_capacity(list.len() / nodes);
        let mut kept = Kept { list: Vec::with_capacity(list.len()), without_area: 0, again: 0 };
        for face in list.chunks_exact(nodes) {
            let mut corners = [usize::MAX; 4];
            corners.iter_mut().zip(face).for_each(|(corner, &node)| *corner = places[node]);
            // The same face may begin at any of its corners; turned to the least number it has one name.
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
        kept
    }
}

/// Whether the corners of a triangle are not on one line; other faces are judged with the cells.
fn has_area(face: &[usize], points: &[[f64; 3]]) -> bool {
    let &[a, b, c] = face else { return true };
    let from = |p: usize, q: usize| -> [f64; 3] { std::array::from_fn(|k| points[q][k] - points[p][k]) };
    let (u, v, w) = (from(a, b), from(a, c), from(b, c));
    let longest = [u, v, w].iter().map(|side| dot(side, side)).fold(0.0, f64::max);
    // The product of two differences of coordinates has a few roundings of the square of the longest side.
    norm(&cross(u, v)) > 4.0 * f64::EPSILON * longest
}
