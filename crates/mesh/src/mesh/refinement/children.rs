//! The cells into which a reference cell is divided.

use super::super::affine::Affine;
use crate::element::Cell;

/// One part of a reference cell: its kind of cell, and the map of that reference cell to it.
pub struct Child {
    pub cell: Cell,
    pub map: Affine,
}

/// The three diagonals of the inner octahedron of a tetrahedron, each from the midpoint of an edge to that of the
/// opposite edge; edges are given by their corners.
pub const DIAGONALS: [[[usize; 2]; 2]; 3] = [[[0, 2], [1, 3]], [[0, 3], [1, 2]], [[0, 1], [2, 3]]];

/// The midpoints of the other four edges around each of the [`DIAGONALS`], neighbours next to each other.
const RINGS: [[[usize; 2]; 4]; 3] =
    [[[0, 1], [1, 2], [2, 3], [0, 3]], [[0, 1], [1, 3], [2, 3], [0, 2]], [[0, 2], [1, 2], [1, 3], [0, 3]]];

/// Halves all edges of a reference cell; none for a cell that such a division does not fill with known cells.
///
/// Intervals, squares, cubes, triangles and wedges are divided into cells of their own kind. A tetrahedron is divided
/// into one at each corner and four around a diagonal of the remaining octahedron (Bey 1995, Computing 55, 355–378),
/// here that of [`DIAGONALS`]`[diagonal]`. A pyramid is divided into five pyramids at its corners, an inverted one
/// under the apex, and four tetrahedra at its triangles.
pub fn children(cell: Cell, diagonal: usize) -> Vec<Child> {
    let own = |map| Child { cell, map };
    match cell {
        Cell::Interval | Cell::Quadrilateral | Cell::Hexahedron => corners_of_box(cell.dimension()).map(own).collect(),
        Cell::Triangle => triangles().map(own).collect(),
        Cell::Wedge => triangles().flat_map(|map| [-0.5, 0.5].map(|at| raised(&map, at))).map(own).collect(),
        Cell::Tetrahedron => tetrahedra(diagonal).map(own).collect(),
        Cell::Pyramid => {
            let tetrahedra = pyramid_tetrahedra().map(|map| Child { cell: Cell::Tetrahedron, map });
            pyramids().into_iter().map(own).chain(tetrahedra).collect()
        }
        // No pentagons of half the size fill a pentagon.
        Cell::Pentagon => Vec::new(),
    }
}

/// A reference cell as a whole.
pub fn whole(cell: Cell) -> Vec<Child> {
    let d = cell.dimension();
    let edge = |k: usize| (0..d).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
    vec![Child { cell, map: Affine { origin: vec![0.0; d], edges: (0..d).map(edge).collect() } }]
}

/// The cell halved in all directions.
fn halved(origin: Vec<f64>) -> Affine {
    let d = origin.len();
    let edge = |k: usize| (0..d).map(|i| if i == k { 0.5 } else { 0.0 }).collect();
    Affine { origin, edges: (0..d).map(edge).collect() }
}

fn corners_of_box(d: usize) -> impl Iterator<Item = Affine> {
    let side = |corner: usize, k: usize| if corner >> k & 1 == 0 { -0.5 } else { 0.5 };
    (0..1 << d).map(move |corner| halved((0..d).map(|k| side(corner, k)).collect()))
}

/// The midpoint of two corners, or a corner if both are equal.
fn middle(cell: Cell, [a, b]: [usize; 2]) -> Vec<f64> {
    let corners = cell.corners();
    corners[a].iter().zip(corners[b]).map(|(a, b)| (a + b) / 2.0).collect()
}

fn triangles() -> impl Iterator<Item = Affine> {
    let parts =
        // The triangle in the middle is turned by half a turn, which keeps the order of its corners.
        [[[0, 0], [0, 1], [0, 2]], [[0, 1], [1, 1], [1, 2]], [[0, 2], [1, 2], [2, 2]], [[1, 2], [0, 2], [0, 1]]];
    parts.into_iter().map(|part| Affine::onto_simplex(&part.map(|pair| middle(Cell::Triangle, pair))))
}

/// A part of the triangle as the lower or upper half of a wedge.
fn raised(triangle: &Affine, at: f64) -> Affine {
    let with = |x: &[f64], z: f64| [x, &[z]].concat();
    let mut edges: Vec<Vec<f64>> = triangle.edges.iter().map(|edge| with(edge, 0.0)).collect();
    edges.push(vec![0.0, 0.0, 0.5]);
    Affine { origin: with(&triangle.origin, at), edges }
}

fn tetrahedra(diagonal: usize) -> impl Iterator<Item = Affine> {
    let at_corner = |a: usize| [0, 1, 2, 3].map(|b| [a.min(b), a.max(b)]);
    let ([from, to], ring) = (DIAGONALS[diagonal], RINGS[diagonal]);
    let around = move |i: usize| [from, to, ring[i], ring[(i + 1) % 4]];
    let parts = (0..4).map(at_corner).chain((0..4).map(around));
    parts.map(|part| oriented(part.map(|pair| middle(Cell::Tetrahedron, pair))))
}

fn pyramids() -> Vec<Affine> {
    let corner = |x: f64, y: f64| halved(vec![x, y, 0.0]);
    // This pyramid stands on its head. Its first two edges are exchanged, so that the determinant of the map stays
    // above zero.
    let hanging = vec![vec![0.0, 0.5, 0.0], vec![0.5, 0.0, 0.0], vec![0.0, 0.0, -0.5]];
    let top = vec![0.0, 0.0, 0.5];
    vec![
        corner(-0.5, -0.5),
        corner(0.5, -0.5),
        corner(0.5, 0.5),
        corner(-0.5, 0.5),
        halved(top.clone()),
        Affine { origin: top, edges: hanging },
    ]
}

/// From the midpoints of the edges of a triangle to the centre of the base.
fn pyramid_tetrahedra() -> impl Iterator<Item = Affine> {
    let part = |a: usize| {
        let b = (a + 1) % 4;
        [[a, b], [a, 4], [b, 4], [0, 2]].map(|pair| middle(Cell::Pyramid, pair))
    };
    (0..4).map(move |a| oriented(part(a)))
}

/// The tetrahedron with these corners, with two of them exchanged if its volume would be negative.
fn oriented(mut corners: [Vec<f64>; 4]) -> Affine {
    let map = Affine::onto_simplex(&corners);
    let [u, v, w] = [&map.edges[0], &map.edges[1], &map.edges[2]];
    let across = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    // A map of a negative determinant would make a cell that is inside out.
    if across.iter().zip(w).map(|(n, w)| n * w).sum::<f64>() > 0.0 {
        return map;
    }
    corners.swap(2, 3);
    Affine::onto_simplex(&corners)
}
