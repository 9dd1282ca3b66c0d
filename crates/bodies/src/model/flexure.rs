//! How a flat sheet with hinges bends as a whole.
//!
//! Theory: page *Sheets that bend* of the book.

use super::network::{MeasureSpring, Network};
use crate::element::SpringKind;
use crate::mesh::Mesh;
use crate::springs::{cross, dot, norm};
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;

/// The height of a point over the plane of a flat sheet, relative to its extent: coordinates in files have six digits or more.
const FLAT: f64 = 1e-5;

/// The mean flexural stiffness of the hinges of a flat sheet, N·m, in the order xx, yy, xy with the twist 2 κ_xy, in axes of its plane. It is the energy under
/// constant curvatures per area of the triangles that have a neighbour at each edge; a triangle has the share of its area in the energy of an edge. `None` if the
/// sheet is not flat, or no triangle is inside.
///
/// With the turns a_i of the triangles at an edge where the director does not turn, and `s_i ψ` those by the motion ψ of the director across the edge, the energy
/// of an edge is `½ min_ψ Σ_i k_i (a_i + s_i ψ)²`.
pub fn hinge_flexure(mesh: &Mesh, network: &Network) -> Option<Matrix3<f64>> {
    let directors = mesh.directors.as_ref()?;
    let axes = plane(mesh)?;
    let mut edges: BTreeMap<usize, Vec<&MeasureSpring>> = BTreeMap::new();
    for spring in network.others.iter().filter(|spring| spring.kind == SpringKind::Hinge) {
        edges.entry(spring.points[3]).or_default().push(spring);
    }
    let area = |nodes: &[usize]| norm(&mesh.area_vector(nodes));
    let shared: BTreeMap<usize, Matrix3<f64>> = edges
        .into_iter()
        // At a free edge the director follows its one triangle, and nothing bends.
        .filter(|(_, springs)| springs.len() > 1)
        .map(|(director, springs)| {
            let areas: f64 = springs.iter().map(|spring| area(&spring.points[..3])).sum();
            let ends = directors.edges[director - mesh.node_count()];
            (director, of_edge(mesh, &axes, ends, &springs) / areas)
        })
        .collect();
    let (mut stiffness, mut areas) = (Matrix3::zeros(), 0.0);
    for (cell, nodes) in mesh.blocks[0].cells().enumerate() {
        let Some(of_edges) =
            directors.of_cell(cell).iter().map(|director| shared.get(director)).collect::<Option<Vec<_>>>()
        else {
            continue;
        };
        let own = area(nodes);
        of_edges.into_iter().for_each(|of_edge| stiffness += own * of_edge);
        areas += own;
    }
    (areas > 0.0).then(|| stiffness / areas)
}

/// The stiffness of an edge against curvatures.
fn of_edge(mesh: &Mesh, axes: &[[f64; 3]; 3], [a, b]: [usize; 2], springs: &[&MeasureSpring]) -> Matrix3<f64> {
    let in_plane = |p: usize| [0, 1].map(|k| dot(mesh.point(p), &axes[k]) - dot(mesh.point(0), &axes[k]));
    let along: [f64; 3] = std::array::from_fn(|k| mesh.point(b)[k] - mesh.point(a)[k]);
    let across = cross(along, axes[2]);
    let (mut own, mut mixed, mut of_director) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
    for spring in springs {
        let x: Vec<f64> = spring.points.iter().flat_map(|&p| mesh.point(p)).copied().collect();
        let gradient = spring.measure.gradient(&x, 3);
        let mut turns = Vector3::zeros();
        for (place, &p) in spring.points[..3].iter().enumerate() {
            let [x, y] = in_plane(p);
            let rise = dot(&gradient[3 * place..3 * place + 3], &axes[2]);
            // A sheet of constant curvatures rises by `κ_x x²/2 + κ_y y²/2 + κ_xy x y/2`, where κ_xy is twice the mixed
            // derivative.
            turns += rise * Vector3::new(x * x / 2.0, y * y / 2.0, x * y / 2.0);
        }
        let by_director = dot(&gradient[9..12], &across);
        own += spring.constant * turns * turns.transpose();
        mixed += spring.constant * by_director * turns;
        of_director += spring.constant * by_director * by_director;
    }
    // The director turns to where the energy is least: the unknown ψ is eliminated.
    own - mixed * mixed.transpose() / of_director
}

/// Whether the nodes of a surface are in one plane.
pub fn is_flat(mesh: &Mesh) -> bool {
    plane(mesh).is_some()
}

/// Two axes in the plane of the nodes, and its normal; `None` if they are not in a plane.
fn plane(mesh: &Mesh) -> Option<[[f64; 3]; 3]> {
    let nodes = mesh.blocks.first()?.cells().next().filter(|_| mesh.cell_dimension() == 2)?;
    let area = mesh.area_vector(nodes);
    let normal = area.map(|a| a / norm(&area));
    let edge: [f64; 3] = std::array::from_fn(|k| mesh.point(nodes[1])[k] - mesh.point(nodes[0])[k]);
    let first = edge.map(|x| x / norm(&edge));
    let from = |p: usize| -> [f64; 3] { std::array::from_fn(|k| mesh.point(p)[k] - mesh.point(nodes[0])[k]) };
    let extent = (0..mesh.node_count()).map(|p| norm(&from(p))).fold(0.0, f64::max);
    let is_flat = (0..mesh.node_count()).all(|p| dot(&from(p), &normal).abs() <= FLAT * extent);
    is_flat.then(|| [first, cross(normal, first), normal])
}
