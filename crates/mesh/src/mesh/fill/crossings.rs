//! Faces of a surface that pass through each other.

use super::columns::Columns;
use super::filled::FaceCrossings;
use super::surface::Surface;
use super::triangles::NOT_OF_FILE;
use crate::mesh::source::MeshSource;
use crate::mesh::space;
use robust::{Coord3D, orient3d};

/// The largest number of pairs of boxes that are compared. A surface of a million faces needs some ten million.
const MOST_PAIRS: usize = 200_000_000;

/// One pair, and how many there are.
#[derive(Default)]
struct Found {
    pairs: usize,
    /// The order by which one pair is chosen, its triangles, and where they cross.
    one: Option<(f64, [u32; 2], [f64; 3])>,
}

impl Found {
    fn add(&mut self, order: f64, triangles: [u32; 2], at: [f64; 3]) {
        self.pairs += 1;
        if self.one.is_none_or(|(least, of, _)| (order, triangles) < (least, of)) {
            self.one = Some((order, triangles, at));
        }
    }
}

/// The faces of a surface that pass through each other, and the pair that is nearest to a place, or the first in the file.
///
/// An edge crosses a triangle if its ends are on different sides and its line passes through the inside; the signs are exact. Layers
/// that lie on each other or touch are no crossing. If `touching`, edges that pass through the border of a triangle count where there
/// is nothing else, as those of boxes along the axes do.
pub(super) fn crossings(
    source: &MeshSource,
    surface: &Surface,
    columns: &Columns,
    near: Option<[f64; 3]>,
    touching: bool,
) -> Option<FaceCrossings> {
    let (mut inside, mut border) = (Found::default(), Found::default());
    each_crossing(surface, columns, |pair, at, is_inside| {
        let order = near.map_or(0.0, |near| (0..3).map(|k| (at[k] - near[k]).powi(2)).sum());
        if is_inside { &mut inside } else { &mut border }.add(order, pair, at);
    });
    let found = if inside.pairs == 0 && touching { border } else { inside };
    let (_, pair, at) = found.one?;
    let faces = pair.map(|triangle| name(source, surface.faces[triangle as usize]));
    Some(FaceCrossings { pairs: found.pairs, faces, at })
}

/// Visits each pair of triangles that cross, the lower first, with the place and whether it is inside one of them rather than on its border.
pub(super) fn each_crossing(surface: &Surface, columns: &Columns, mut visit: impl FnMut([u32; 2], [f64; 3], bool)) {
    let mut compared = 0;
    let mut boxes: Vec<(u32, [[f64; 3]; 2])> = Vec::new();
    'squares: for (square, triangles) in columns.squares() {
        boxes.clear();
        boxes.extend(triangles.iter().map(|&index| (index, ends(surface, index))));
        // Sorted by their lower ends, boxes that begin above the end of one need not be compared with it.
        boxes.sort_unstable_by(|(i, a), (j, b)| a[0][2].total_cmp(&b[0][2]).then(i.cmp(j)));
        for (n, (i, a)) in boxes.iter().enumerate() {
            for (j, b) in boxes[n + 1..].iter().take_while(|(_, b)| b[0][2] <= a[1][2]) {
                compared += 1;
                // What has been found is told as a least number: the search is for a message and must end.
                if compared > MOST_PAIRS {
                    break 'squares;
                }
                // Two boxes may share several squares; the one with the lowest corner of what they share counts.
                let low = [0, 1].map(|k| a[0][k].max(b[0][k]));
                if (0..2).any(|k| low[k] > a[1][k].min(b[1][k])) || columns.square(low) != square {
                    continue;
                }
                let Some((at, is_inside)) = crossing(surface, *i, *j) else { continue };
                visit([*i.min(j), *i.max(j)], at, is_inside);
            }
        }
    }
}

/// The box of a triangle.
fn ends(surface: &Surface, index: u32) -> [[f64; 3]; 2] {
    space::ends(surface.triangles[index as usize].map(|p| surface.points[p]).into_iter())
}

/// Where two triangles cross, and whether it is inside one of them rather than on its border.
fn crossing(surface: &Surface, i: u32, j: u32) -> Option<([f64; 3], bool)> {
    let (a, b) = (surface.triangles[i as usize], surface.triangles[j as usize]);
    let mut on_border = None;
    for (of, through) in [(a, b), (b, a)] {
        for k in 0..3 {
            let edge = [of[k], of[(k + 1) % 3]];
            // Neighbours meet in what they share, which is no crossing.
            if edge.iter().any(|p| through.contains(p)) {
                continue;
            }
            match passing(edge.map(|p| surface.points[p]), through.map(|p| surface.points[p])) {
                Some((at, true)) => return Some((at, true)),
                Some((at, false)) => on_border = Some((at, false)),
                None => {}
            }
        }
    }
    on_border
}

/// Where the line between p and q passes through a triangle, and whether through its inside.
fn passing([p, q]: [[f64; 3]; 2], [a, b, c]: [[f64; 3]; 3]) -> Option<([f64; 3], bool)> {
    let volume = |x: [[f64; 3]; 4]| {
        let [a, b, c, d] = x.map(|[x, y, z]| Coord3D { x, y, z });
        orient3d(a, b, c, d)
    };
    // Signs are exact: an edge that ends in the plane of a triangle touches it.
    let (from, to) = (volume([a, b, c, p]), volume([a, b, c, q]));
    if !(from < 0.0 && to > 0.0 || from > 0.0 && to < 0.0) {
        return None;
    }
    let around = [[a, b], [b, c], [c, a]].map(|[x, y]| volume([p, q, x, y]));
    // A line that passes through a triangle goes round all its edges the same way.
    if around.iter().any(|v| *v < 0.0) && around.iter().any(|v| *v > 0.0) {
        return None;
    }
    let share = from / (from - to);
    Some((std::array::from_fn(|k| p[k] + share * (q[k] - p[k])), around.iter().all(|v| *v != 0.0)))
}

/// A face by its place in the file, in words.
fn name(source: &MeshSource, face: u32) -> String {
    if face == NOT_OF_FILE {
        return "a triangle that closes a hole".into();
    }
    let mut place = face as usize;
    for block in source.blocks.iter().filter(|block| block.dimension > 1) {
        let count = block.connectivity.len() / block.nodes_per_cell;
        if place < count {
            let kind = if block.nodes_per_cell == 3 { "triangle" } else { "quadrangle" };
            let of = if block.groups.is_empty() { String::new() } else { format!(" of {}", block.groups.join(", ")) };
            return format!("{kind} {}{of}", place + 1);
        }
        place -= count;
    }
    format!("face {}", face + 1)
}
