//! Reference cells: the closed list of shapes an element can have.

use serde::Deserialize;

/// A reference cell. Intervals, squares and cubes span [-1, 1] in each coordinate; simplices are the corner at the
/// origin with unit legs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cell {
    Interval,
    Triangle,
    Quadrilateral,
    Tetrahedron,
    Hexahedron,
}

/// A side of a cell: its own shape, and where its corners stand in the cell.
#[derive(Debug, Clone, Copy)]
pub struct Side {
    pub cell: Cell,
    pub corners: &'static [usize],
}

const fn side(cell: Cell, corners: &'static [usize]) -> Side {
    Side { cell, corners }
}

impl Cell {
    pub fn dimension(self) -> usize {
        match self {
            Cell::Interval => 1,
            Cell::Triangle | Cell::Quadrilateral => 2,
            Cell::Tetrahedron | Cell::Hexahedron => 3,
        }
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
            Cell::Tetrahedron => 1.0 / 6.0,
            Cell::Hexahedron => 8.0,
        }
    }

    /// The corners' reference coordinates.
    pub fn corners(self) -> &'static [&'static [f64]] {
        match self {
            Cell::Interval => &[&[-1.], &[1.]],
            Cell::Triangle => &[&[0., 0.], &[1., 0.], &[0., 1.]],
            Cell::Quadrilateral => &[&[-1., -1.], &[1., -1.], &[1., 1.], &[-1., 1.]],
            Cell::Tetrahedron => &[&[0., 0., 0.], &[1., 0., 0.], &[0., 1., 0.], &[0., 0., 1.]],
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

    /// The sides of one dimension less.
    pub fn sides(self) -> &'static [Side] {
        use Cell::{Interval, Quadrilateral, Triangle};
        match self {
            Cell::Interval => &[],
            Cell::Triangle => const { &[side(Interval, &[0, 1]), side(Interval, &[1, 2]), side(Interval, &[2, 0])] },
            Cell::Quadrilateral => {
                const {
                    &[
                        side(Interval, &[0, 1]),
                        side(Interval, &[1, 2]),
                        side(Interval, &[2, 3]),
                        side(Interval, &[3, 0]),
                    ]
                }
            }
            Cell::Tetrahedron => {
                const {
                    &[
                        side(Triangle, &[0, 2, 1]),
                        side(Triangle, &[0, 1, 3]),
                        side(Triangle, &[1, 2, 3]),
                        side(Triangle, &[0, 3, 2]),
                    ]
                }
            }
            Cell::Hexahedron => {
                const {
                    &[
                        side(Quadrilateral, &[0, 3, 2, 1]),
                        side(Quadrilateral, &[4, 5, 6, 7]),
                        side(Quadrilateral, &[0, 1, 5, 4]),
                        side(Quadrilateral, &[1, 2, 6, 5]),
                        side(Quadrilateral, &[2, 3, 7, 6]),
                        side(Quadrilateral, &[3, 0, 4, 7]),
                    ]
                }
            }
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
