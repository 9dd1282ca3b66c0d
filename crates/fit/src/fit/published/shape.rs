//! The shapes of cells for which formulas are made.

use super::corners::{Corners, Joint};

/// A shape for which a formula is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// All edges are equal, and all diagonals: the equilateral triangle, the square, the regular tetrahedron, the cube.
    Regular,
    /// Opposite edges are equal, and the diagonals.
    Rectangle,
}

crate::named!(Shape { "regular" => Regular, "rectangle" => Rectangle });

impl Shape {
    /// The largest relative deviation from their mean of two lengths that are equal in this shape; `length` measures a
    /// pair of corners.
    pub fn deviation(self, corners: &Corners, length: impl Fn([usize; 2]) -> f64) -> f64 {
        let spread = |pairs: &[[usize; 2]]| {
            let lengths = || pairs.iter().map(|pair| length(*pair));
            let mean = lengths().sum::<f64>() / pairs.len() as f64;
            lengths().map(|l| (l / mean - 1.0).abs()).fold(0.0, f64::max)
        };
        let joined = |joint: Joint| corners.joined(joint).collect::<Vec<_>>();
        let edges = joined(Joint::Edge);
        let diagonals = spread(&joined(Joint::FaceDiagonal)).max(spread(&joined(Joint::Diagonal)));
        let along = |direction: usize| {
            let own: Vec<_> = edges.iter().copied().filter(|&e| corners.direction(e) == Some(direction)).collect();
            spread(&own)
        };
        match self {
            Shape::Regular => diagonals.max(spread(&edges)),
            Shape::Rectangle => (0..corners.facing.len()).map(along).fold(diagonals, f64::max),
        }
    }
}
