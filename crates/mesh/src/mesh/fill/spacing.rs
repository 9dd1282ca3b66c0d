//! How large the cubes of a fill are.

use super::bound::MOST_CELLS;
use crate::error::{Error, ErrorKind, Result};

/// How large the cubes of a fill are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FillSpacing {
    /// Their edges have this length, m.
    Edge(f64),
    /// The mesh has about so many points: within a hundredth where some edge gives that, and as near as possible otherwise.
    Points(usize),
}

/// A difference from the number of points that is near enough.
const NEAR: f64 = 0.01;
/// How many edges are tried: halving between a factor of two apart, so many differ by less than an edge changes the cells.
const TRIES: usize = 20;
/// The smallest number of points: a cube has eight.
const LEAST: usize = 8;

impl FillSpacing {
    /// # Errors
    /// The edge is no length, or the number of points is out of range.
    pub(super) fn check(self) -> Result<()> {
        match self {
            FillSpacing::Edge(edge) if edge > 0.0 && edge.is_finite() => Ok(()),
            FillSpacing::Edge(edge) => Err(Error::expected("cell", "a positive length", format!("{edge} m"))),
            FillSpacing::Points(points) if points > MOST_CELLS => {
                let expected = format!("{LEAST} to {MOST_CELLS} points");
                Err(Error::expected("points", expected, points).of_kind(ErrorKind::Limit))
            }
            FillSpacing::Points(points) if points < LEAST => {
                Err(Error::expected("points", format!("{LEAST} to {MOST_CELLS} points"), points))
            }
            FillSpacing::Points(_) => Ok(()),
        }
    }

    /// The edge of a cube, m, in a surface with this volume, m³; `count` is the number of points with an edge.
    ///
    /// # Errors
    /// The count fails; the error has the key `points`.
    pub(super) fn edge(self, volume: f64, of_cube: usize, count: impl Fn(f64) -> Result<usize>) -> Result<f64> {
        let wanted = match self {
            FillSpacing::Edge(edge) => return Ok(edge),
            FillSpacing::Points(points) => points as f64,
        };
        // A cube has one corner of its own, and with tetrahedra its centre as well.
        let mut edge = (if of_cube > 1 { 2.0 } else { 1.0 } * volume / wanted).cbrt();
        // Edges with more and with fewer points than wanted.
        let (mut fine, mut coarse) = (0.0, f64::INFINITY);
        let mut best = (f64::INFINITY, edge);
        for _ in 0..TRIES {
            let points = count(edge).map_err(|e| e.at_key("points"))? as f64;
            let away = (points / wanted - 1.0).abs();
            if away < best.0 {
                best = (away, edge);
            }
            if away <= NEAR {
                break;
            }
            if points > wanted {
                fine = edge
            } else {
                coarse = edge
            }
            // Points are about as many as cubes; a surface with none has too large ones.
            let next = edge * (points.max(wanted / 8.0) / wanted).cbrt();
            edge = match (fine > 0.0, coarse.is_finite()) {
                // Edges count by their ratios, so that the middle of two is their geometric mean.
                (true, true) if !(next > fine && next < coarse) || away < 0.1 => (fine * coarse).sqrt(),
                _ => next,
            };
        }
        Ok(best.1)
    }
}
