//! How far cells and material are from what a method takes for granted.

use super::corners::Corners;
use super::method::{Joint, Method, Ratio};
use super::{Elasticity, each_cell};
use crate::element::Element;
use crate::error::Result;
use crate::material::Material;
use crate::springs::distance;

/// A shape that a formula is made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// All edges alike, and all diagonals: the equilateral triangle, the square, the regular tetrahedron, the cube.
    Regular,
    /// Opposite edges alike, and the diagonals.
    Rectangle,
}

/// What cells and material lack of what a method takes for granted; nothing if it equals `Unmet::default()`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Unmet {
    /// The Poisson's ratio that the constants are made for, where the material's (in the plane, of the plane) is another.
    pub poisson: Option<f64>,
    /// Cells of another shape.
    pub cells: usize,
    /// By how much two lengths differ that the shape makes equal, as a part of their mean; the largest over all cells.
    pub deviation: f64,
}

/// Below this a deviation is rounding of a mesh file's digits.
const ROUNDING: f64 = 1e-6;

/// Compares cells, `[cells × nodes]` into `points`, and material with what the method takes for granted.
///
/// # Errors
/// The method has no formula for the element, or a cell is reversed, tangled or flat.
pub fn unmet(
    method: Method,
    element: &Element,
    points: &[f64],
    connectivity: &[usize],
    material: Material,
) -> Result<Unmet> {
    let cover = method.cover(element)?;
    let corners = Corners::of(element)?;
    let ratio = Elasticity::of(element, material)?.poisson;
    let mut unmet = Unmet::default();
    if let Ratio::Only(assumed) = cover.poisson {
        unmet.poisson = Some(assumed).filter(|assumed| (assumed - ratio).abs() > ROUNDING);
    }
    let Some(shape) = cover.shape else { return Ok(unmet) };
    let d = element.dimension();
    each_cell(element, points, connectivity, 0, |_, x, _| {
        let length = |[a, b]: [usize; 2]| distance(&x[a * d..(a + 1) * d], &x[b * d..(b + 1) * d]);
        let deviation = shape.deviation(&corners, length);
        unmet.cells += usize::from(deviation > ROUNDING);
        unmet.deviation = unmet.deviation.max(deviation);
    })?;
    if unmet.cells == 0 {
        unmet.deviation = 0.0;
    }
    Ok(unmet)
}

impl Unmet {
    /// Of cells of both kinds.
    pub fn and(self, other: Unmet) -> Unmet {
        Unmet {
            poisson: self.poisson.or(other.poisson),
            cells: self.cells + other.cells,
            deviation: self.deviation.max(other.deviation),
        }
    }
}

impl Shape {
    pub fn name(self) -> &'static str {
        match self {
            Shape::Regular => "regular",
            Shape::Rectangle => "rectangle",
        }
    }

    fn deviation(self, corners: &Corners, length: impl Fn([usize; 2]) -> f64) -> f64 {
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
