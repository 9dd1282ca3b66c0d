//! Sheets that hang on a surface and enclose nothing: fins, flaps, and walls across the inside.

use super::patches::Patches;
use crate::mesh::fill::edges::{by_edge, passes};
use crate::mesh::fill::triangles::Triangles;
use std::collections::HashMap;

/// The triangles of sheets that were left out.
pub(super) struct Sheets {
    /// Triangles with an area have this number.
    pub triangles: usize,
    /// Triangles without an area, such as the splinters of a cut, have this number.
    pub flat: usize,
}

/// The height of a triangle, relative to the diagonal of the box around the surface, at which it has no area: coordinates in single precision are
/// rounded by less.
const FLAT: f64 = 1e-6;

/// Leaves out patches at whose every edge the surface goes on without them: fins that end somewhere and are joined to edges of two or more
/// other triangles, and walls all of whose edges have two other triangles. Small patches go first: of a wall between two chambers and the chambers' outer sides, that is the wall.
pub(super) fn leave_out(triangles: &mut Triangles) -> Sheets {
    let mut sheets = Sheets { flat: splinters(triangles), triangles: 0 };
    let passes = passes(&triangles.corners);
    let patches = Patches::of(triangles, &passes);
    // A single patch is the surface itself.
    if patches.count < 2 {
        return sheets;
    }
    // The edges at the border of patches with the number of their triangles, and which patches meet there.
    let mut counts: HashMap<[usize; 2], usize> = HashMap::new();
    let mut borders: Vec<Vec<[usize; 2]>> = vec![Vec::new(); patches.count];
    for of_edge in by_edge(&passes).filter(|of_edge| of_edge.len() != 2) {
        counts.insert(of_edge[0].edge, of_edge.len());
        of_edge.iter().for_each(|pass| borders[patches.of[pass.triangle as usize]].push(pass.edge));
    }
    let mut areas = vec![0.0; patches.count];
    triangles.corners.iter().zip(&patches.of).for_each(|(corners, patch)| areas[*patch] += triangles.area(*corners));
    let mut order: Vec<usize> = (0..patches.count).collect();
    order.sort_by(|a, b| areas[*a].total_cmp(&areas[*b]).then(a.cmp(b)));
    let mut is_sheet = vec![false; patches.count];
    for patch in order {
        let border = &mut borders[patch];
        border.sort_unstable();
        // A patch that has an edge twice goes on through it.
        let is_once = !border.is_empty() && border.windows(2).all(|pair| pair[0] != pair[1]);
        // One that ends somewhere is no side of a chamber, however many meet at its other edges.
        let is_fin = border.iter().any(|edge| counts[edge] == 1) && border.iter().all(|edge| counts[edge] != 2);
        let is_wall = border.iter().all(|edge| counts[edge] == 3);
        if is_once && (is_wall || is_fin && border.iter().any(|edge| counts[edge] > 2)) {
            is_sheet[patch] = true;
            // What is left out no longer counts at its edges: a wall behind it may be a sheet now, or a side of the body.
            border.iter().for_each(|edge| *counts.entry(*edge).or_default() -= 1);
        }
    }
    sheets.triangles = patches.of.iter().filter(|patch| is_sheet[**patch]).count();
    triangles.retain(|t| !is_sheet[patches.of[t]]);
    sheets
}

/// Leaves out triangles without an area that have an edge for themselves; returns how many there were. Those between neighbours stay, because
/// they close the surface.
fn splinters(triangles: &mut Triangles) -> usize {
    let (given, flat) = (triangles.corners.len(), FLAT * triangles.extent());
    loop {
        let count = triangles.corners.len();
        let mut is_splinter = vec![false; count];
        for of_edge in by_edge(&passes(&triangles.corners)).filter(|of_edge| of_edge.len() == 1) {
            let triangle = of_edge[0].triangle as usize;
            is_splinter[triangle] = triangles.height(triangles.corners[triangle]) <= flat;
        }
        triangles.retain(|t| !is_splinter[t]);
        if triangles.corners.len() == count {
            return given - count;
        }
    }
}
