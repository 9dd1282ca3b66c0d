//! Cubes around a surface.

use super::surface::Surface;

/// Cubes of one edge from `origin`, so many along each axis that they hold the surface.
pub(super) struct Grid {
    pub origin: [f64; 3],
    pub counts: [i32; 3],
    /// m.
    pub edge: f64,
}

impl Grid {
    /// The cubes around a surface, in the middle of its box.
    pub fn around(surface: &Surface, edge: f64) -> Grid {
        // A side that is a whole number of edges long has that many cubes, whatever the rounding of the quotient is.
        let counts = [0, 1, 2].map(|k| ((surface.high[k] - surface.low[k]) / edge - 1e-9).ceil().max(1.0) as i32);
        let middle = |k: usize| surface.low[k] / 2.0 + surface.high[k] / 2.0;
        Grid { origin: std::array::from_fn(|k| middle(k) - f64::from(counts[k]) / 2.0 * edge), counts, edge }
    }

    /// The cubes along an axis, with one more at each end.
    pub fn along(&self, k: usize) -> std::ops::Range<i32> {
        -1..self.counts[k] + 1
    }

    /// A place in eighths of an edge, m.
    pub fn place(&self, eighths: [i32; 3]) -> [f64; 3] {
        std::array::from_fn(|k| self.origin[k] + f64::from(eighths[k]) / 8.0 * self.edge)
    }

    /// A place in half edges, m.
    pub fn site(&self, halves: [i32; 3]) -> [f64; 3] {
        self.place(halves.map(|half| 4 * half))
    }
}
