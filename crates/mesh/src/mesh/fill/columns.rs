//! How often a surface winds around the points of an upright line.
//!
//! The winding number of a point counts the triangles above it, those with their outside up as 1 and the others as −1. Signs of
//! determinants are exact (Shewchuk 1997), and a line that meets an edge or a corner is treated as one that is moved by an
//! infinitesimal `(ε, ε²)` (Edelsbrunner, Mücke 1990), so that it meets one of the triangles there.

use super::surface::Surface;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// The triangles by squares of the plane x, y.
pub(super) struct Columns<'a> {
    surface: &'a Surface,
    width: [f64; 2],
    counts: [usize; 2],
    bins: Vec<Vec<u32>>,
}

/// A place where a line passes through a triangle.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    triangle: [usize; 3],
    /// 1 if the outside of the triangle is up, otherwise −1.
    sign: i32,
    /// About the height, m.
    height: f64,
}

/// The largest number of entries of bins; with more, bins are made wider. They have 200 MB.
const MOST_ENTRIES: usize = 50_000_000;

impl<'a> Columns<'a> {
    pub fn of(surface: &'a Surface) -> Columns<'a> {
        let extent = [0, 1].map(|k| surface.high[k] - surface.low[k]);
        // About as many bins as triangles, of which each then has a few.
        let mut side = (surface.triangles.len() as f64).sqrt().clamp(1.0, 2000.0);
        loop {
            let counts = [side as usize; 2];
            // A surface without extent along an axis has bins of no width, by which nothing may be divided.
            let width = [0, 1].map(|k| (extent[k] / side.floor()).max(f64::MIN_POSITIVE));
            let mut columns = Columns { surface, width, counts, bins: vec![Vec::new(); counts[0] * counts[1]] };
            if columns.fill() || side < 2.0 {
                return columns;
            }
            side /= 2.0;
        }
    }

    /// Sorts the triangles into the bins; `false` if there are too many entries.
    fn fill(&mut self) -> bool {
        let mut entries = 0;
        for (index, triangle) in self.surface.triangles.iter().enumerate() {
            let corners = triangle.map(|p| self.surface.points[p]);
            let end = |k: usize, pick: fn(f64, f64) -> f64| corners.iter().map(|x| x[k]).reduce(pick).unwrap_or(0.0);
            let low = [0, 1].map(|k| self.bin(k, end(k, f64::min)));
            let high = [0, 1].map(|k| self.bin(k, end(k, f64::max)));
            entries += (high[0] - low[0] + 1) * (high[1] - low[1] + 1);
            // Large triangles are in many bins: with wider bins there are fewer entries. One bin for all always serves.
            if entries > MOST_ENTRIES {
                return self.counts == [1, 1];
            }
            for i in low[0]..=high[0] {
                for j in low[1]..=high[1] {
                    self.bins[i * self.counts[1] + j].push(index as u32);
                }
            }
        }
        true
    }

    /// The squares of the plane, with the triangles whose boxes reach into each.
    pub fn squares(&self) -> impl Iterator<Item = ([usize; 2], &[u32])> {
        let columns = self.counts[1];
        self.bins.iter().enumerate().map(move |(index, bin)| ([index / columns, index % columns], bin.as_slice()))
    }

    /// The square of a place in the plane.
    pub fn square(&self, at: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|k| self.bin(k, at[k]))
    }

    fn bin(&self, k: usize, x: f64) -> usize {
        let place = (x - self.surface.low[k]) / self.width[k];
        // Rounding may put a place on the border outside of the bins.
        (place.max(0.0) as usize).min(self.counts[k] - 1)
    }

    /// The triangles that the line through (x, y) passes through.
    fn crossings(&self, x: f64, y: f64, found: &mut Vec<Crossing>) {
        found.clear();
        let at = [x, y];
        // Bins at the border would take places outside of the box for their own.
        if (0..2).any(|k| at[k] < self.surface.low[k] || at[k] > self.surface.high[k]) {
            return;
        }
        for &index in &self.bins[self.bin(0, x) * self.counts[1] + self.bin(1, y)] {
            let triangle = self.surface.triangles[index as usize];
            let corners = triangle.map(|p| self.surface.points[p]);
            let [a, b, c] = corners;
            let sign = side(a, b, x, y);
            if sign != 0 && sign == side(b, c, x, y) && sign == side(c, a, x, y) {
                found.push(Crossing { triangle, sign, height: height(corners, x, y) });
            }
        }
    }

    /// How often the surface winds around each of the points at `(x, y, z + k step)`, k from 0 to below `count`. `crossings` is room to work.
    pub fn windings(
        &self,
        start: [f64; 3],
        step: f64,
        count: usize,
        crossings: &mut Vec<Crossing>,
        found: &mut Vec<i32>,
    ) {
        self.crossings(start[0], start[1], crossings);
        found.clear();
        if crossings.is_empty() {
            return;
        }
        // First by how much the winding changes at each point, then their sums.
        found.resize(count + 1, 0);
        for crossing in crossings.iter() {
            found[0] += crossing.sign;
            found[self.below(crossing, start, step, count)] -= crossing.sign;
        }
        found.truncate(count);
        let mut winding = 0;
        for change in found {
            winding += *change;
            *change = winding;
        }
    }

    /// How often the surface winds around a place.
    pub fn winding(&self, at: [f64; 3]) -> i32 {
        let (mut crossings, mut found) = (Vec::new(), Vec::new());
        self.windings(at, 1.0, 1, &mut crossings, &mut found);
        found.first().copied().unwrap_or(0)
    }

    /// How many of the points at `(x, y, z + k step)`, k from 0 to below `count`, are below the crossing.
    fn below(&self, crossing: &Crossing, [x, y, z]: [f64; 3], step: f64, count: usize) -> usize {
        let corners = crossing.triangle.map(|p| self.surface.points[p]);
        let [a, b, c] = corners.map(|[x, y, z]| Coord3D { x, y, z });
        // Positive if the point is below the plane of a triangle whose corners run counter-clockwise as seen from above.
        let is_below = |k: usize| {
            let volume = orient3d(a, b, c, Coord3D { x, y, z: z + k as f64 * step });
            volume * f64::from(crossing.sign) > 0.0
        };
        // The guess is rounded and may be off by a few steps; exact signs correct it.
        let guess = ((crossing.height - z) / step).clamp(0.0, count as f64);
        let mut k = guess as usize;
        while k < count && is_below(k) {
            k += 1;
        }
        while k > 0 && !is_below(k - 1) {
            k -= 1;
        }
        k
    }
}

/// On which side of the line from a to b the moved point is: 1 on the left, −1 on the right, 0 if a and b coincide in the plane.
fn side(a: [f64; 3], b: [f64; 3], x: f64, y: f64) -> i32 {
    let value = orient2d(Coord { x: a[0], y: a[1] }, Coord { x: b[0], y: b[1] }, Coord { x, y });
    // The derivatives of the determinant along ε and ε².
    // The sign of the first that is not zero is that of the point moved by `(ε, ε²)`, however small ε is.
    let order = [value, a[1] - b[1], b[0] - a[0]];
    order.into_iter().find(|value| *value != 0.0).map_or(0, |value| if value > 0.0 { 1 } else { -1 })
}

/// The height of the plane of a triangle at (x, y), m; the middle height of one that is almost upright.
fn height([a, b, c]: [[f64; 3]; 3], x: f64, y: f64) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let area = u[0] * v[1] - u[1] * v[0];
    let (p, q) = (x - a[0], y - a[1]);
    let height = a[2] + ((p * v[1] - q * v[0]) * (b[2] - a[2]) + (u[0] * q - u[1] * p) * (c[2] - a[2])) / area;
    let (low, high) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
    // Rounding over a small area may lead beyond the corners, between which all heights are.
    if height.is_finite() { height.clamp(low, high) } else { (low + high) / 2.0 }
}
