//! Reference cells: the closed list of shapes an element can have.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A reference cell. Intervals, squares and cubes span [-1, 1] in each coordinate; simplices are the corner at the
/// origin with unit legs. A wedge is the triangle times [-1, 1]; a pyramid stands on the square, its apex at (0, 0, 1); the
/// corners of the pentagon are rational points of the unit circle, nearly evenly spaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Cell {
    Interval,
    Triangle,
    Quadrilateral,
    Pentagon,
    Tetrahedron,
    Hexahedron,
    Wedge,
    Pyramid,
}

const PENTAGON: [&[f64]; 5] =
    [&[3. / 5., -4. / 5.], &[176. / 185., 57. / 185.], &[0., 1.], &[-176. / 185., 57. / 185.], &[-3. / 5., -4. / 5.]];

/// A side of a cell: its own shape, and where its corners stand in the cell.
#[derive(Debug, Clone, Copy)]
pub struct Side {
    pub cell: Cell,
    pub corners: &'static [usize],
}

impl Cell {
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

    pub fn dimension(self) -> usize {
        match self {
            Cell::Interval => 1,
            Cell::Triangle | Cell::Quadrilateral | Cell::Pentagon => 2,
            Cell::Tetrahedron | Cell::Hexahedron | Cell::Wedge | Cell::Pyramid => 3,
        }
    }

    /// Whether it is a product of intervals.
    pub fn is_box(self) -> bool {
        matches!(self, Cell::Interval | Cell::Quadrilateral | Cell::Hexahedron)
    }

    pub fn is_simplex(self) -> bool {
        matches!(self, Cell::Triangle | Cell::Tetrahedron)
    }

    /// Length, area or volume of the reference cell.
    pub fn content(self) -> f64 {
        match self {
            Cell::Interval => 2.0,
            Cell::Triangle => 1.0 / 2.0,
            Cell::Quadrilateral => 4.0,
            // Half the cross products of successive corners.
            Cell::Pentagon => 2199.0 / 925.0,
            Cell::Tetrahedron => 1.0 / 6.0,
            Cell::Hexahedron => 8.0,
            Cell::Wedge => 1.0,
            Cell::Pyramid => 4.0 / 3.0,
        }
    }

    /// The corners' reference coordinates.
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

    /// The mean of the corners.
    pub fn centre(self) -> Vec<f64> {
        let corners = self.corners();
        (0..self.dimension()).map(|k| corners.iter().map(|c| c[k]).sum::<f64>() / corners.len() as f64).collect()
    }

    /// Exponents of the products of coordinates that a map of the cell with straight edges may hold beyond the linear ones.
    pub fn straight_terms(self) -> &'static [&'static [i32]] {
        match self {
            Cell::Quadrilateral => &[&[1, 1]],
            Cell::Hexahedron => &[&[1, 1, 0], &[1, 0, 1], &[0, 1, 1], &[1, 1, 1]],
            Cell::Wedge => &[&[1, 0, 1], &[0, 1, 1]],
            _ => &[],
        }
    }

    /// Pairs of corners that an edge joins.
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
        if edges.is_empty() { vec![[0, 1]] } else { edges }
    }

    /// Whether the point is in the cell or on its boundary, to rounding.
    pub fn contains(self, at: &[f64]) -> bool {
        let centre = self.centre();
        if self == Cell::Interval {
            return at[0].abs() <= 1.0 + 1e-12;
        }
        self.sides().iter().all(|side| {
            let (origin, tangents) = side.embedding(self);
            let above = |x: &[f64]| height(x, &origin, &tangents);
            above(at) * above(&centre).signum() >= -1e-12
        })
    }

    /// The sides of one dimension less.
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
    /// The affine map from the side's own reference cell into that of `parent`: origin, then one tangent per coordinate.
    ///
    /// `ξ(s) = origin + Σ_k s_k tangent_k`.
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
            // The centre of [-1, 1]^k is at s = 0, so the first corner is one tangent back in each direction.
            for tangent in &tangents {
                origin.iter_mut().zip(tangent).for_each(|(o, t)| *o += t);
            }
        }
        (origin, tangents)
    }
}

/// Distance of `x` above the line or plane `origin + span(tangents)`, times the tangents' length or area.
pub fn height(x: &[f64], origin: &[f64], tangents: &[Vec<f64>]) -> f64 {
    let r: Vec<f64> = x.iter().zip(origin).map(|(a, b)| a - b).collect();
    match tangents {
        [t] => r[0] * t[1] - r[1] * t[0],
        [s, t] => {
            let normal = [s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2], s[0] * t[1] - s[1] * t[0]];
            normal.iter().zip(&r).map(|(n, r)| n * r).sum()
        }
        _ => f64::INFINITY,
    }
}
