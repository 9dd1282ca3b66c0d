//! Reference cells: the closed list of shapes that an element can have.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Coordinates of reference cells, which are of size one, are equal if they differ by less: files give them with ten digits or
/// more, and no two nodes are as near.
pub(super) const SAME: f64 = 1e-9;

/// Whether two places in a reference cell are the same.
pub fn same_place(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME)
}

/// The reference cell of an element.
///
/// Intervals, squares and cubes span [−1, 1] in each coordinate. Triangle and tetrahedron have their corners at the
/// origin and at the unit points of the axes. A wedge is the triangle times [−1, 1]. A pyramid has the square as its
/// base and its apex at (0, 0, 1). The corners of the pentagon are rational points of the unit circle, nearly evenly
/// spaced, so that exact arithmetic is possible.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Cell {
    /// One dimension, [−1, 1].
    Interval,
    /// The simplex of two dimensions.
    Triangle,
    /// The square [−1, 1]².
    Quadrilateral,
    /// Five corners on the unit circle.
    Pentagon,
    /// The simplex of three dimensions.
    Tetrahedron,
    /// The cube [−1, 1]³.
    Hexahedron,
    /// A triangle times an interval: a triangular prism.
    Wedge,
    /// A square base and an apex.
    Pyramid,
}

/// Rational points of the unit circle near the corners of the regular pentagon.
const PENTAGON: [&[f64]; 5] =
    [&[3. / 5., -4. / 5.], &[176. / 185., 57. / 185.], &[0., 1.], &[-176. / 185., 57. / 185.], &[-3. / 5., -4. / 5.]];

/// A side of a cell: its own shape, and where its corners are in the cell.
#[derive(Debug, Clone, Copy)]
pub struct Side {
    /// The reference cell of the side.
    pub cell: Cell,
    /// The corners of the parent cell at which the corners of the side are.
    pub corners: &'static [usize],
}

impl Cell {
    /// All cells, by dimension.
    pub const ALL: [Cell; 8] = [
        Cell::Interval,
        Cell::Triangle,
        Cell::Quadrilateral,
        Cell::Pentagon,
        Cell::Tetrahedron,
        Cell::Hexahedron,
        Cell::Wedge,
        Cell::Pyramid,
    ];

    /// The number of reference coordinates.
    pub fn dimension(self) -> usize {
        match self {
            Cell::Interval => 1,
            Cell::Triangle | Cell::Quadrilateral | Cell::Pentagon => 2,
            Cell::Tetrahedron | Cell::Hexahedron | Cell::Wedge | Cell::Pyramid => 3,
        }
    }

    /// Whether the cell is a product of intervals.
    pub fn is_box(self) -> bool {
        matches!(self, Cell::Interval | Cell::Quadrilateral | Cell::Hexahedron)
    }

    /// Whether the cell is a triangle or a tetrahedron.
    pub fn is_simplex(self) -> bool {
        matches!(self, Cell::Triangle | Cell::Tetrahedron)
    }

    /// Length, area or volume of the reference cell, without a unit.
    pub fn content(self) -> f64 {
        match self {
            Cell::Interval => 2.0,
            Cell::Triangle => 1.0 / 2.0,
            Cell::Quadrilateral => 4.0,
            // Half the sum of the cross products of successive corners.
            Cell::Pentagon => 2199.0 / 925.0,
            Cell::Tetrahedron => 1.0 / 6.0,
            Cell::Hexahedron => 8.0,
            Cell::Wedge => 1.0,
            Cell::Pyramid => 4.0 / 3.0,
        }
    }

    /// The reference coordinates of the corners, `[corners][dimension]`.
    pub fn corners(self) -> &'static [&'static [f64]] {
        match self {
            Cell::Interval => &[&[-1.], &[1.]],
            Cell::Triangle => &[&[0., 0.], &[1., 0.], &[0., 1.]],
            Cell::Quadrilateral => &[&[-1., -1.], &[1., -1.], &[1., 1.], &[-1., 1.]],
            Cell::Pentagon => &PENTAGON,
            Cell::Tetrahedron => &[&[0., 0., 0.], &[1., 0., 0.], &[0., 1., 0.], &[0., 0., 1.]],
            Cell::Wedge => {
                &[&[0., 0., -1.], &[1., 0., -1.], &[0., 1., -1.], &[0., 0., 1.], &[1., 0., 1.], &[0., 1., 1.]]
            }
            Cell::Pyramid => &[&[-1., -1., 0.], &[1., -1., 0.], &[1., 1., 0.], &[-1., 1., 0.], &[0., 0., 1.]],
            Cell::Hexahedron => &[
                &[-1., -1., -1.],
                &[1., -1., -1.],
                &[1., 1., -1.],
                &[-1., 1., -1.],
                &[-1., -1., 1.],
                &[1., -1., 1.],
                &[1., 1., 1.],
                &[-1., 1., 1.],
            ],
        }
    }

    /// The mean of the corners, `[dimension]`.
    pub fn centre(self) -> Vec<f64> {
        let corners = self.corners();
        (0..self.dimension()).map(|k| corners.iter().map(|c| c[k]).sum::<f64>() / corners.len() as f64).collect()
    }

    /// The exponents of the products of coordinates, beyond the linear terms, that the map of a cell with straight
    /// edges can contain.
    pub fn straight_terms(self) -> &'static [&'static [i32]] {
        match self {
            Cell::Quadrilateral => &[&[1, 1]],
            Cell::Hexahedron => &[&[1, 1, 0], &[1, 0, 1], &[0, 1, 1], &[1, 1, 1]],
            Cell::Wedge => &[&[1, 0, 1], &[0, 1, 1]],
            _ => &[],
        }
    }

    /// Pairs of corners that are joined by an edge.
    pub fn edges(self) -> Vec<[usize; 2]> {
        let mut edges: Vec<[usize; 2]> = Vec::new();
        for side in self.sides() {
            let corners = side.corners;
            let next = |i: usize| corners[(i + 1) % corners.len()];
            for (i, &a) in corners.iter().enumerate().filter(|(i, a)| **a != next(*i)) {
                let edge = [a.min(next(i)), a.max(next(i))];
                if !edges.contains(&edge) {
                    edges.push(edge);
                }
            }
        }
        // An interval has no sides with two corners: it is its own edge.
        if edges.is_empty() { vec![[0, 1]] } else { edges }
    }

    /// The place in `positions`, `[nodes × dimension]`, of the node at a corner, if there is one.
    pub fn corner_node(self, corner: usize, positions: &[f64]) -> Option<usize> {
        let at = self.corners()[corner];
        positions.chunks_exact(at.len()).position(|x| same_place(x, at))
    }

    /// Whether the point is in the cell or on its boundary, up to rounding.
    pub fn contains(self, at: &[f64]) -> bool {
        let centre = self.centre();
        if self == Cell::Interval {
            // Points of rules and sides are computed, and those on the boundary may be a rounding outside.
            return at[0].abs() <= 1.0 + 1e-12;
        }
        self.sides().iter().all(|side| {
            let (origin, tangents) = side.embedding(self);
            let above = |x: &[f64]| height(x, &origin, &tangents);
            // The order of corners decides the sign of heights, which that of the centre makes positive inside. A
            // rounding of the places may be outside.
            above(at) * above(&centre).signum() >= -1e-12
        })
    }

    /// The sides, which have one dimension less.
    pub fn sides(self) -> &'static [Side] {
        use Cell::{Interval, Quadrilateral, Triangle};
        macro_rules! sides {
            ($($cell:ident $corners:expr),*) => { const { &[$(Side { cell: $cell, corners: &$corners }),*] } };
        }
        match self {
            Cell::Interval => &[],
            Cell::Triangle => sides![Interval [0, 1], Interval [1, 2], Interval [2, 0]],
            Cell::Quadrilateral => sides![Interval [0, 1], Interval [1, 2], Interval [2, 3], Interval [3, 0]],
            Cell::Pentagon => {
                sides![Interval [0, 1], Interval [1, 2], Interval [2, 3], Interval [3, 4], Interval [4, 0]]
            }
            Cell::Tetrahedron => {
                sides![Triangle [0, 2, 1], Triangle [0, 1, 3], Triangle [1, 2, 3], Triangle [0, 3, 2]]
            }
            Cell::Hexahedron => sides![
                Quadrilateral [0, 3, 2, 1],
                Quadrilateral [4, 5, 6, 7],
                Quadrilateral [0, 1, 5, 4],
                Quadrilateral [1, 2, 6, 5],
                Quadrilateral [2, 3, 7, 6],
                Quadrilateral [3, 0, 4, 7]
            ],
            Cell::Wedge => sides![
                Triangle [0, 2, 1],
                Triangle [3, 4, 5],
                Quadrilateral [0, 1, 4, 3],
                Quadrilateral [1, 2, 5, 4],
                Quadrilateral [2, 0, 3, 5]
            ],
            Cell::Pyramid => sides![
                Quadrilateral [0, 3, 2, 1],
                Triangle [0, 1, 4],
                Triangle [1, 2, 4],
                Triangle [2, 3, 4],
                Triangle [3, 0, 4]
            ],
        }
    }
}

impl Side {
    /// The affine map `ξ(s) = origin + Σ_k s_k tangent_k` from the side's own reference cell into that of `parent`: the
    /// origin, and one tangent per coordinate of the side.
    pub fn embedding(&self, parent: Cell) -> (Vec<f64>, Vec<Vec<f64>>) {
        let corner = |i: usize| parent.corners()[self.corners[i]];
        let between = |i: usize, j: usize, f: f64| corner(i).iter().zip(corner(j)).map(|(a, b)| f * (b - a)).collect();
        let tangents: Vec<Vec<f64>> = match self.cell {
            Cell::Triangle => vec![between(0, 1, 1.0), between(0, 2, 1.0)],
            Cell::Quadrilateral => vec![between(0, 1, 0.5), between(0, 3, 0.5)],
            _ => vec![between(0, 1, 0.5)],
        };
        let mut origin = corner(0).to_vec();
        if !self.cell.is_simplex() {
            // The centre of [−1, 1]^k is at s = 0, so the origin is the first corner plus one tangent in each
            // direction.
            for tangent in &tangents {
                origin.iter_mut().zip(tangent).for_each(|(o, t)| *o += t);
            }
        }
        (origin, tangents)
    }
}

/// The distance of `x` above the line or plane `origin + span(tangents)`, multiplied by the length or area of the
/// tangents.
pub fn height(x: &[f64], origin: &[f64], tangents: &[Vec<f64>]) -> f64 {
    let r: Vec<f64> = x.iter().zip(origin).map(|(a, b)| a - b).collect();
    match tangents {
        // Heights are determinants, not distances: their sign counts, and no root is needed.
        [t] => r[0] * t[1] - r[1] * t[0],
        [s, t] => {
            let normal = [s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2], s[0] * t[1] - s[1] * t[0]];
            normal.iter().zip(&r).map(|(n, r)| n * r).sum()
        }
        _ => f64::INFINITY,
    }
}
