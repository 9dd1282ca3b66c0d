//! Hanging points: points on sides of cells to which they do not belong.

use super::mesh::{CellIndex, Mesh};
use super::places::Places;
use super::space::{ends, spatial};
use crate::element::{Cell, Element};
use crate::springs::{distance, dot};
use std::collections::{HashMap, HashSet};

/// The largest distance of a hanging point from a side, relative to the extent of the side.
const TOLERANCE: f64 = 1e-6;
/// Newton iterations for the nearest position of a curved side. Sides bend little, so that a point without a position
/// after them has none near.
const ITERATIONS: usize = 20;

/// A side on the boundary, or a cell of a curve, on which only its own points should lie.
struct Host<'a> {
    element: &'a Element,
    /// The shape of the side, and the map from its own coordinates to those of the cell.
    cell: Cell,
    origin: Vec<f64>,
    tangents: Vec<Vec<f64>>,
    /// The nodes of the element, and their points.
    nodes: Vec<usize>,
    points: Vec<usize>,
}

impl Mesh {
    /// The number of points on an edge or a face of a cell that does not have them, anywhere on it. Points at the
    /// position of one of its own do not count. Only sides on the boundary are tested: no point lies on a side that two
    /// cells share, unless a cell is folded. Cells that lie over others of what they share are added to `overlapping`.
    pub(super) fn hanging(&self, places: &Places, overlapping: &mut HashSet<CellIndex>) -> usize {
        let hosts = self.hosts(overlapping);
        let mut candidates: Vec<usize> = hosts.iter().flat_map(|host| host.points.iter().copied()).collect();
        // A point belongs to several sides, and is looked up once.
        candidates.sort_unstable();
        candidates.dedup();
        let boxes: Vec<[[f64; 3]; 2]> = hosts.iter().map(|host| self.surroundings(host)).collect();
        let mean = boxes.iter().map(|[low, high]| distance(low, high)).sum::<f64>() / boxes.len().max(1) as f64;
        let bin = |x: f64| (x / mean).floor() as i64;
        let mut bins: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        for &p in &candidates {
            bins.entry(spatial(self.point(p)).map(bin)).or_default().push(p);
        }
        let mut hanging = HashSet::new();
        for (host, [low, high]) in hosts.iter().zip(&boxes) {
            // No farther than a tenth of the shortest edge, so that no neighbour of a side is taken for a point on it.
            let reach = places.rounding.max((TOLERANCE * distance(low, high)).min(0.1 * places.shortest_edge));
            let (from, to) = (low.map(|x| bin(x - reach)), high.map(|x| bin(x + reach)));
            let mut test = |p: usize| {
                let x = spatial(self.point(p));
                let inside = (0..3).all(|k| (low[k] - reach..=high[k] + reach).contains(&x[k]));
                // Parts of a mesh that are not joined have points at the same places, which are told as coincident and not as hanging.
                let own = || host.points.iter().any(|q| places.first[*q] == places.first[p]);
                if inside && !hanging.contains(&p) && !own() && self.lies_on(p, host, reach) {
                    hanging.insert(p);
                }
            };
            let count = (0..3).map(|k| (to[k] - from[k]) as f64 + 1.0).product::<f64>();
            // A side much larger than most would cover more bins than there are points.
            if count > candidates.len() as f64 {
                candidates.iter().for_each(|&p| test(p));
                continue;
            }
            for i in from[0]..=to[0] {
                for j in from[1]..=to[1] {
                    for k in from[2]..=to[2] {
                        bins.get(&[i, j, k]).into_iter().flatten().for_each(|&p| test(p));
                    }
                }
            }
        }
        hanging.len()
    }

    fn hosts(&self, overlapping: &mut HashSet<CellIndex>) -> Vec<Host<'_>> {
        let element = |at: CellIndex| &*self.blocks[at.block].element;
        if self.cell_dimension() == 1 {
            let host = |at: CellIndex| {
                let points = self.cell_nodes(at).to_vec();
                let nodes = (0..points.len()).collect();
                let (origin, tangents) = (vec![0.0], vec![vec![1.0]]);
                Host { element: element(at), cell: Cell::Interval, origin, tangents, nodes, points }
            };
            return self.cell_indices().map(host).collect();
        }
        let mut hosts = Vec::new();
        self.each_side_set(|sides| {
            self.add_overlapping(sides, overlapping);
            if let [index] = sides {
                let element = element(index.cell);
                let side = element.cell.sides()[index.side];
                let (origin, tangents) = side.embedding(element.cell);
                let nodes = element.sides()[index.side].nodes.clone();
                let points = self.side_nodes(index);
                hosts.push(Host { element, cell: side.cell, origin, tangents, nodes, points });
            }
        });
        hosts
    }

    /// A box around a side; a curved side extends beyond its nodes.
    fn surroundings(&self, host: &Host) -> [[f64; 3]; 2] {
        let [low, high] = ends(host.points.iter().map(|&p| spatial(self.point(p))));
        // A curved side leaves the box of its nodes, by less than a quarter of its extent unless it is folded.
        let bulge = if host.points.len() > host.cell.corners().len() { 0.25 * distance(&low, &high) } else { 0.0 };
        [low.map(|x| x - bulge), high.map(|x| x + bulge)]
    }

    /// Whether the nearest position `x(s) = Σ_a N_a(s) x_a` of a side is within `reach` of the point and between the
    /// ends of the side.
    fn lies_on(&self, point: usize, host: &Host, reach: f64) -> bool {
        let (d, goal) = (self.dimension, self.point(point));
        let mut s = host.cell.centre();
        for _ in 0..ITERATIONS {
            let xi: Vec<f64> = (0..host.origin.len())
                .map(|l| host.origin[l] + s.iter().zip(&host.tangents).map(|(s, t)| s * t[l]).sum::<f64>())
                .collect();
            let functions = &host.element.functions;
            let mut rest = goal.to_vec();
            let mut slopes = vec![vec![0.0; d]; s.len()];
            for (&a, &p) in host.nodes.iter().zip(&host.points) {
                let x = self.point(p);
                let value = functions.values[a].evaluate(&xi);
                rest.iter_mut().zip(x).for_each(|(r, x)| *r -= value * x);
                let gradient: Vec<f64> = functions.gradients[a].iter().map(|g| g.evaluate(&xi)).collect();
                for (slope, tangent) in slopes.iter_mut().zip(&host.tangents) {
                    let along = dot(&gradient, tangent);
                    slope.iter_mut().zip(x).for_each(|(slope, x)| *slope += along * x);
                }
            }
            // (x′ᵀ x′) Δs = x′ᵀ (goal − x)
            let step: Vec<f64> = match &slopes[..] {
                [one] => vec![dot(one, &rest) / dot(one, one)],
                [one, two] => {
                    let (a, b, c) = (dot(one, one), dot(one, two), dot(two, two));
                    let (f, g, determinant) = (dot(one, &rest), dot(two, &rest), a * c - b * b);
                    vec![(c * f - b * g) / determinant, (a * g - b * f) / determinant]
                }
                _ => return false,
            };
            // A side of no extent has a singular matrix, and no place between its ends.
            if !step.iter().all(|step| step.is_finite()) {
                return false;
            }
            // Cells are of size one, and the next step would be at rounding.
            if step.iter().all(|step| step.abs() < 1e-10) {
                // The ends belong to the side, within the tolerance.
                let centre = host.cell.centre();
                let inner: Vec<f64> =
                    s.iter().zip(&centre).map(|(s, c)| c + (s - c) * (1.0 - 4.0 * TOLERANCE)).collect();
                return host.cell.contains(&inner) && dot(&rest, &rest).sqrt() <= reach;
            }
            s.iter_mut().zip(&step).for_each(|(s, step)| *s += step);
        }
        false
    }
}
