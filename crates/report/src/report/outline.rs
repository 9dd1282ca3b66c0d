//! The edges of cells that are seen from outside; straight between corners.

use crate::element::Element;
use crate::mesh::{CellBlock, Mesh, Selection, SideIndex};
use std::collections::BTreeSet;

/// The edges of all cells of a curve or in the plane; of a solid those on its surface.
pub(super) fn cell_edges(mesh: &Mesh) -> Vec<[usize; 2]> {
    edges_of_sides(mesh, |_, _| true)
}

/// Finds the edges of all cells of a curve or in the plane; of a solid those of the sides for which `is_seen` holds, which is given their
/// corners and the centre of their cell.
pub(super) fn edges_of_sides(mesh: &Mesh, is_seen: impl Fn(&[&[f64]], [f64; 3]) -> bool) -> Vec<[usize; 2]> {
    let mut edges = BTreeSet::new();
    let mut add = |element: &Element, nodes: &[usize], corners: &[usize]| {
        let around = (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]]);
        for ends in around {
            let at = ends.map(|corner| element.corner_node(corner).map(|a| nodes[a]));
            if let [Some(a), Some(b)] = at {
                edges.insert([a.min(b), a.max(b)]);
            }
        }
    };
    match mesh.cell_dimension() {
        0 | 1 => {
            for block in &mesh.blocks {
                block.cells().for_each(|cell| add(&block.element, cell, &[0, 1]));
            }
        }
        2 => {
            for block in &mesh.blocks {
                let sides = block.element.cell.sides();
                block.cells().for_each(|cell| sides.iter().for_each(|side| add(&block.element, cell, side.corners)));
            }
        }
        _ => {
            for SideIndex { cell, side } in Selection::Everything.sides(mesh).unwrap_or_default() {
                let CellBlock { element, connectivity } = &mesh.blocks[cell.block];
                let nodes = &connectivity[cell.cell * element.nodes()..][..element.nodes()];
                let corners = element.cell.sides()[side].corners;
                let points: Option<Vec<&[f64]>> =
                    corners.iter().map(|&c| element.corner_node(c).map(|a| mesh.point(nodes[a]))).collect();
                let centre = |k: usize| nodes.iter().map(|&p| mesh.point(p)[k]).sum::<f64>() / nodes.len() as f64;
                if points.is_some_and(|points| is_seen(&points, [centre(0), centre(1), centre(2)])) {
                    add(element, nodes, corners);
                }
            }
        }
    }
    edges.into_iter().collect()
}
