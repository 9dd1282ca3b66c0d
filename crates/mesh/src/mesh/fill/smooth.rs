//! Tetrahedra of a body-centred cubic lattice that is cut off at a surface.

use super::bound::{MOST_CELLS, too_many};
use super::columns::{Columns, Crossing};
use super::filled::Filled;
use super::grid::Grid;
use super::lattice::Pattern;
use super::parts::kept;
use super::snapping::{Site, Snapping};
use super::stencils::{Knot, left};
use crate::element::Element;
use crate::error::Result;
use crate::mesh::mesh::{CellBlock, Mesh};
use crate::mesh::space::minus;
use crate::springs::{cross, dot};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Barycentric weights of nodes are compared in units of this: those of elements are fractions of small numbers.
const WEIGHT: f64 = (1u64 << 20) as f64;

/// The mesh of a surface, without groups.
///
/// # Errors
/// There are too many cells.
pub(super) fn smooth(
    element: &Arc<Element>,
    grid: &Grid,
    columns: &Columns,
    patterns: &[Pattern],
    filled: &mut Filled,
) -> Result<Mesh> {
    let snapping = Snapping::of(grid, columns, sites_inside(grid, columns, filled)?);
    let mut known: HashMap<Knot, usize> = HashMap::new();
    let mut places: Vec<[f64; 3]> = Vec::new();
    let mut cells: Vec<Vec<usize>> = Vec::new();
    for cube in snapping.cubes() {
        for pattern in patterns {
            let site = |a: usize| -> Site { std::array::from_fn(|k| 2 * cube[k] + pattern.corners[a][k]) };
            for knots in left(std::array::from_fn(site), |site| snapping.side(site)) {
                let corners = knots.map(|knot| {
                    *known.entry(knot).or_insert_with(|| {
                        places.push(match knot {
                            Knot::Site(site) => snapping.place(site),
                            Knot::Cut(edge) => snapping.cut(edge),
                        });
                        places.len() - 1
                    })
                });
                cells.push(corners.to_vec());
            }
        }
        if cells.len() > MOST_CELLS {
            return Err(too_many());
        }
    }
    let faces: Vec<&[usize]> = element.cell.sides().iter().map(|side| side.corners).collect();
    let keep = kept(&cells, &faces);
    filled.loose = keep.iter().filter(|keep| !**keep).count();
    let cells: Vec<Vec<usize>> = cells.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(cell, _)| cell).collect();
    let corners = |cell: &Vec<usize>| -> [[f64; 3]; 4] { std::array::from_fn(|a| places[cell[a]]) };
    // The corners of cut cells are in any order, which the mesh turns alike only later.
    filled.volume = cells.iter().map(|cell| volume(&corners(cell)).abs()).sum();
    filled.angles = cells.iter().flat_map(|cell| dihedral_angles(&corners(cell))).fold(None, |ends, angle| {
        let [least, largest] = ends.unwrap_or([angle; 2]);
        Some([f64::min(least, angle), f64::max(largest, angle)])
    });
    let mut mesh = Mesh::of_points(3, Vec::new());
    mesh.blocks
        .push(CellBlock { element: element.clone(), connectivity: nodes(element, &cells, &places, &mut mesh.points) });
    Ok(mesh)
}

/// The nodes of cells with these corners, whose coordinates are added to `points`. Nodes with the same weights of the same corners are
/// one.
fn nodes(element: &Element, cells: &[Vec<usize>], places: &[[f64; 3]], points: &mut Vec<f64>) -> Vec<usize> {
    let mut known: HashMap<Vec<(usize, u64)>, usize> = HashMap::new();
    let mut connectivity = Vec::with_capacity(cells.len() * element.nodes());
    for cell in cells {
        for at in element.positions.chunks_exact(3) {
            let weights = [1.0 - at.iter().sum::<f64>(), at[0], at[1], at[2]];
            // Whole weights of neighbours are equal to the bit, however the coordinates of their nodes were rounded.
            let parts = (0..4).map(|a| (cell[a], (weights[a] * WEIGHT).round().max(0.0) as u64));
            let mut key: Vec<(usize, u64)> = parts.filter(|(_, weight)| *weight > 0).collect();
            // Neighbours name the corners of a common side in other orders.
            key.sort_unstable();
            let next = points.len() / 3;
            let index = *known.entry(key).or_insert(next);
            if index == next {
                points.extend((0..3).map(|k| (0..4).map(|a| weights[a] * places[cell[a]][k]).sum::<f64>()));
            }
            connectivity.push(index);
        }
    }
    connectivity
}

/// The sites of the lattice around which the surface winds.
fn sites_inside(grid: &Grid, columns: &Columns, filled: &mut Filled) -> Result<HashSet<Site>> {
    let mut inside = HashSet::new();
    let mut crossings: Vec<Crossing> = Vec::new();
    let mut windings = Vec::new();
    // The lattice is two lattices of cubes, of corners and of centres.
    for of_centres in [0, 1] {
        for i in grid.along(0) {
            for j in grid.along(1) {
                let site = |k: i32| [2 * i + of_centres, 2 * j + of_centres, 2 * k + of_centres];
                columns.windings(grid.site(site(-1)), grid.edge, grid.along(2).len(), &mut crossings, &mut windings);
                for (k, winding) in grid.along(2).zip(&windings) {
                    if *winding > 0 {
                        inside.insert(site(k));
                    }
                    filled.note(*winding, || grid.site(site(k)));
                }
            }
        }
        if inside.len() > MOST_CELLS {
            return Err(too_many());
        }
    }
    Ok(inside)
}

fn volume([a, b, c, d]: &[[f64; 3]; 4]) -> f64 {
    let [u, v, w] = [b, c, d].map(|x| minus(x, a));
    dot(&u, &cross(v, w)) / 6.0
}

/// The angle at each edge of a tetrahedron between the sides that share it, degrees.
fn dihedral_angles(x: &[[f64; 3]; 4]) -> [f64; 6] {
    let pairs = [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]];
    pairs.map(|[a, b, c, d]| {
        let along = minus(&x[b], &x[a]);
        let [m, n] = [c, d].map(|p| cross(along, minus(&x[p], &x[a])));
        let sine = cross(m, n);
        // By sine and cosine: an arccosine alone loses half of the digits near 0° and 180°.
        dot(&sine, &sine).sqrt().atan2(dot(&m, &n)).to_degrees()
    })
}
