//! Generates round discs and domes of triangles.

use super::mesh::{CellBlock, CellIndex, Group, Mesh, sorted};
use super::places::Places;
use crate::bound;
use crate::element::{Cell, Element};
use crate::error::{Error, Result};
use crate::range;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The largest number of points, see [`bound::CELLS`].
const MOST_POINTS: usize = bound::CELLS as usize;

/// A disc about the origin, of linear triangles: a central point and concentric rings of points at equal distances, the
/// last of which is the rim.
///
/// With rings of `n_1 … n_R` points it has `N = 1 + Σ n_r` points, `T = 2 Σ n_r − n_R` triangles and `E = N + T − 1`
/// edges (Euler), whatever the numbers are. With a `height` other than zero it is a dome in space,
/// `z = height (1 − r²/radius²)`. The groups are `rim`, `middle` and `body`.
#[derive(Debug, Clone)]
pub struct DiscMesh {
    /// The element of all cells, a linear triangle.
    pub element: Arc<Element>,
    /// The radius, m.
    pub radius: f64,
    /// The height of the dome, m; 0 for a plane disc.
    pub height: f64,
    /// The number of points of each ring, from the innermost.
    pub rings: Vec<usize>,
}

impl DiscMesh {
    /// Rings that each have six points more than the previous one, which gives nearly equilateral triangles.
    pub fn even(rings: usize) -> Vec<usize> {
        (1..=rings).map(|r| 6 * r).collect()
    }

    /// Rings with `points` points in all, including the central one, and `rim` points on the last ring; the others grow
    /// as evenly as whole numbers allow, `n_r ≈ c r`. The mesh has `2 points − 2 − rim` triangles.
    pub fn rings_of(points: usize, rings: usize, rim: usize) -> Vec<usize> {
        // Too few points leave rings without any, which `build` refuses.
        let inner = points.saturating_sub(1 + rim);
        let last = rings.saturating_sub(1);
        // The number of points up to ring r.
        // Rounded to the nearest and then subtracted, so that the rings together have all the points. A single ring has no inner ones.
        let up_to = |r: usize| (inner * r * (r + 1) + last * (last + 1) / 2) / (last * (last + 1)).max(1);
        (1..=last).map(|r| up_to(r) - up_to(r - 1)).chain([rim]).collect()
    }

    /// Generates the mesh.
    ///
    /// # Errors
    /// The element is not a linear triangle, a length is not positive, or a ring has fewer than three points.
    pub fn build(&self) -> Result<Mesh> {
        if self.element.cell != Cell::Triangle || self.element.nodes() != 3 {
            return Err(Error::expected("element", "a triangle of three nodes", &self.element.name));
        }
        range::positive("radius", self.radius, "m")?;
        range::largest("height", [self.height], "m")?;
        // Counts of a user: their sum may be larger than any number here.
        let total = self.rings.iter().try_fold(1usize, |sum, n| sum.checked_add(*n)).unwrap_or(usize::MAX);
        if self.rings.is_empty() || self.rings.iter().any(|n| *n < 3) || total > MOST_POINTS {
            let expected = format!("rings of three points or more, {MOST_POINTS} in all at most");
            return Err(Error::expected("rings", expected, format!("{:?}", self.rings)));
        }
        let dimension = if self.height == 0.0 { 2 } else { 3 };
        let element = match dimension {
            2 => self.element.clone(),
            _ => Arc::new(Element::clone(&self.element).in_space(3)),
        };
        let mut mesh = Mesh::of_points(dimension, self.points(dimension));
        mesh.blocks.push(CellBlock { element, connectivity: self.triangles() });
        let rim = self.rings[self.rings.len() - 1];
        let around: Vec<usize> = (total - rim..total).collect();
        let side = |i: usize| sorted(&[around[i], around[(i + 1) % rim]]);
        let sides = (0..rim).map(side).collect();
        mesh.groups.insert("rim".into(), Group { points: around.clone(), sides, ..Group::default() });
        mesh.groups.insert("middle".into(), Group { points: vec![0], ..Group::default() });
        let cells = (0..mesh.cell_count()).map(|cell| CellIndex { block: 0, cell }).collect();
        mesh.groups.insert("body".into(), Group { points: (0..total).collect(), cells, ..Group::default() });
        mesh.orient(false)?;
        // Nobody has numbered these cells, so none is to be told of as reversed.
        mesh.reversed = 0;
        mesh.quality.pieces = Some(mesh.pieces().len());
        mesh.quality.coincident = Places::of(&mesh).map(|places| places.coincident());
        Ok(mesh)
    }

    fn points(&self, dimension: usize) -> Vec<f64> {
        let ring = |(r, &n): (usize, &usize)| (0..n).map(move |i| (r + 1, i as f64 / n as f64));
        let places = [(0, 0.0)].into_iter().chain(self.rings.iter().enumerate().flat_map(ring));
        let mut points = Vec::new();
        for (r, turn) in places {
            let share = r as f64 / self.rings.len() as f64;
            let (sin, cos) = (TAU * turn).sin_cos();
            let at = [self.radius * share * cos, self.radius * share * sin, self.height * (1.0 - share * share)];
            points.extend(&at[..dimension]);
        }
        points
    }

    /// A fan around the centre, then strips between neighbouring rings; in a strip the ring that is behind in angle
    /// advances.
    fn triangles(&self) -> Vec<usize> {
        let first = self.rings[0];
        let mut triangles: Vec<usize> = (0..first).flat_map(|i| [0, 1 + i, 1 + (i + 1) % first]).collect();
        let mut start = 1;
        for pair in self.rings.windows(2) {
            let (n, m) = (pair[0], pair[1]);
            let inner = |i: usize| start + i % n;
            let outer = |j: usize| start + n + j % m;
            let (mut i, mut j) = (0, 0);
            while i < n || j < m {
                // By the middles of the next steps, in whole numbers: no rounding decides between equal angles.
                if j == m || (i < n && (2 * i + 1) * m < (2 * j + 1) * n) {
                    triangles.extend([inner(i), outer(j), inner(i + 1)]);
                    i += 1;
                } else {
                    triangles.extend([inner(i), outer(j), outer(j + 1)]);
                    j += 1;
                }
            }
            start += n;
        }
        triangles
    }
}
