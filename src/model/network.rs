//! The mass-spring model: the springs of all cells, those between the same two points added up.

use super::Entries;
use super::system::dofs;
use crate::element::SpringKind;
use crate::fit::CellFits;
use crate::mesh::{CellBlock, Mesh};
use crate::springs::{Measure, distance};
use crate::stiffness::gather;
use crate::symbolic::Expr;
use faer::sparse::Triplet;
use rayon::prelude::*;
use std::sync::Arc;

/// A spring between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthSpring {
    /// The lower index first.
    pub points: [usize; 2],
    /// N/m.
    pub constant: f64,
    /// Length at rest, m.
    pub rest: f64,
}

/// A spring that measures something else of a few points: an angle, an area, a volume, a coupling, a user's measure.
#[derive(Debug, Clone)]
pub struct MeasureSpring {
    pub kind: SpringKind,
    pub points: Vec<usize>,
    /// In J per square of the measure's unit: of an area N/m³, of a volume N/m⁵, of an angle N·m.
    pub constant: f64,
    /// The measure at rest, m², m³, rad, …
    pub rest: f64,
    pub measure: Measure,
}

/// Springs on the points of a mesh. Springs whose constant is zero are not in it.
#[derive(Debug, Clone, Default)]
pub struct Network {
    pub dimension: usize,
    /// Sorted by their points.
    pub lengths: Vec<LengthSpring>,
    /// Cell after cell.
    pub others: Vec<MeasureSpring>,
}

impl Network {
    /// Adds up the springs of all cells; `fits` has one entry per block of the mesh.
    pub fn assemble(mesh: &Mesh, fits: &[CellFits]) -> Network {
        let mut network = Network { dimension: mesh.dimension, ..Network::default() };
        network.lengths = merge(mesh, fits);
        network.others = mesh.blocks.iter().zip(fits).flat_map(|(block, fit)| others(mesh, block, fit)).collect();
        network
    }

    /// The tangent stiffness at rest, `Σ_s k_s g_s g_sᵀ`, N/m; `points` as in the mesh, `[points × dimension]`.
    pub fn stiffness(&self, points: &[f64]) -> Entries {
        let d = self.dimension;
        let mut entries = Entries::new();
        for spring in &self.lengths {
            let [i, j] = spring.points;
            let n: Vec<f64> = (0..d).map(|k| (points[j * d + k] - points[i * d + k]) / spring.rest).collect();
            for k in 0..d {
                for l in 0..d {
                    let value = spring.constant * n[k] * n[l];
                    if l <= k {
                        entries.push(Triplet::new(i * d + k, i * d + l, value));
                        entries.push(Triplet::new(j * d + k, j * d + l, value));
                    }
                    entries.push(Triplet::new(j * d + k, i * d + l, -value));
                }
            }
        }
        for spring in &self.others {
            let mut x = vec![0.0; spring.points.len() * d];
            gather(points, d, &spring.points, &mut x);
            let gradient = spring.measure.gradient(&x, d);
            for (row, g) in dofs(&spring.points, d).zip(&gradient) {
                for (column, h) in dofs(&spring.points, d).zip(&gradient) {
                    if row >= column {
                        entries.push(Triplet::new(row, column, spring.constant * g * h));
                    }
                }
            }
        }
        entries
    }

    pub fn len(&self) -> usize {
        self.lengths.len() + self.others.len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many constants are below zero.
    pub fn negative(&self) -> usize {
        let lengths = self.lengths.iter().map(|s| s.constant);
        lengths.chain(self.others.iter().map(|s| s.constant)).filter(|k| *k < 0.0).count()
    }
}

/// The springs of one block that measure more than a length, each cell's for itself.
fn others(mesh: &Mesh, block: &CellBlock, fit: &CellFits) -> Vec<MeasureSpring> {
    let (d, springs) = (mesh.dimension, &fit.springs);
    let (m, first) = (springs.len(), springs.pairs.len());
    let every: Vec<usize> = (0..springs.nodes).collect();
    let in_space = |kind: SpringKind, nodes: usize, function: Option<&Arc<Expr>>| match function {
        Some(function) if springs.space == springs.dimension => Measure::Function(function.clone()),
        None if springs.space == springs.dimension => Measure::Content(block.element.clone()),
        _ => Measure::Function(Arc::new(Measure::of_kind(kind, nodes, d).expect("a kind has a formula in any space"))),
    };
    let functions =
        springs.functions.iter().map(|f| (f.kind, &f.nodes, in_space(f.kind, f.nodes.len(), Some(&f.function))));
    let content = springs.content.map(|kind| (kind, &every, in_space(kind, springs.nodes, None)));
    let kinds: Vec<(SpringKind, &Vec<usize>, Measure)> = functions.chain(content).collect();
    let mut all = Vec::new();
    if kinds.is_empty() {
        return all;
    }
    for (nodes, constants) in block.cells().zip(fit.constants.chunks_exact(m)) {
        for ((kind, places, measure), &constant) in kinds.iter().zip(&constants[first..]) {
            if constant == 0.0 {
                continue;
            }
            let points: Vec<usize> = places.iter().map(|&a| nodes[a]).collect();
            let mut x = vec![0.0; points.len() * d];
            gather(&mesh.points, d, &points, &mut x);
            let rest = measure.value(&x, d);
            all.push(MeasureSpring { kind: *kind, points, constant, rest, measure: measure.clone() });
        }
    }
    all
}

/// Points whose springs one thread merges in one go.
const CHUNK: usize = 2048;

/// Adds up the length springs between the same two points. Each point goes through the cells around it and gathers the
/// springs to its higher neighbours in a list of its own, which is short: nothing is sorted or hashed as a whole.
fn merge(mesh: &Mesh, fits: &[CellFits]) -> Vec<LengthSpring> {
    let stars: Vec<Star> = mesh.blocks.iter().zip(fits).map(|(block, fit)| Star::new(mesh, block, fit)).collect();
    let count = mesh.point_count();
    let firsts: Vec<usize> = (0..count).step_by(CHUNK).collect();
    let part = |first: &usize| {
        let mut springs = Vec::new();
        let mut neighbours: Vec<(usize, f64)> = Vec::new();
        for i in *first..(first + CHUNK).min(count) {
            neighbours.clear();
            for star in &stars {
                star.gather(i, &mut neighbours);
            }
            neighbours.sort_unstable_by_key(|(j, _)| *j);
            for &(j, constant) in neighbours.iter().filter(|(_, k)| *k != 0.0) {
                let rest = distance(mesh.point(i), mesh.point(j));
                springs.push(LengthSpring { points: [i, j], constant, rest });
            }
        }
        springs
    };
    let parts: Vec<Vec<LengthSpring>> = firsts.par_iter().map(part).collect();
    parts.concat()
}

/// The cells of one block around each point.
struct Star<'a> {
    block: &'a CellBlock,
    fit: &'a CellFits,
    /// Where the places of each point begin, `[points + 1]`.
    starts: Vec<usize>,
    /// Positions in the connectivity, grouped by the point that stands there.
    places: Vec<usize>,
    /// For each node of the cell its length springs: spring and node at the other end.
    springs: Vec<Vec<(usize, usize)>>,
}

impl<'a> Star<'a> {
    fn new(mesh: &Mesh, block: &'a CellBlock, fit: &'a CellFits) -> Star<'a> {
        let mut starts = vec![0; mesh.point_count() + 1];
        block.connectivity.iter().for_each(|&point| starts[point + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut places = vec![0; block.connectivity.len()];
        for (place, &point) in block.connectivity.iter().enumerate() {
            places[next[point]] = place;
            next[point] += 1;
        }
        let mut springs = vec![Vec::new(); block.element.nodes()];
        for (s, &[a, b]) in fit.springs.pairs.iter().enumerate() {
            springs[a].push((s, b));
            springs[b].push((s, a));
        }
        Star { block, fit, starts, places, springs }
    }

    /// Adds the springs from point i to higher points; each point appears once in `neighbours`.
    fn gather(&self, i: usize, neighbours: &mut Vec<(usize, f64)>) {
        let (n, m) = (self.springs.len(), self.fit.springs.len());
        for &place in &self.places[self.starts[i]..self.starts[i + 1]] {
            let (cell, node) = (place / n, place % n);
            let nodes = &self.block.connectivity[cell * n..(cell + 1) * n];
            let constants = &self.fit.constants[cell * m..(cell + 1) * m];
            for &(s, other) in &self.springs[node] {
                let j = nodes[other];
                if j > i {
                    match neighbours.iter_mut().find(|(point, _)| *point == j) {
                        Some((_, sum)) => *sum += constants[s],
                        None => neighbours.push((j, constants[s])),
                    }
                }
            }
        }
    }
}
