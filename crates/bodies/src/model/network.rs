//! The mass-spring model: the springs of all cells, those between the same two points added up.

use super::Entries;
use super::steady::{is_steady, rest_length, steady_law};
use super::system::dofs;
use crate::element::SpringKind;
use crate::fit::CellFits;
use crate::mesh::{CellBlock, Mesh};
use crate::springs::{Force, FunctionSpring, Law, Measure, distance, linear};
use crate::stiffness::gather;
use faer::sparse::Triplet;
use rayon::prelude::*;
use std::collections::HashMap;
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

impl LengthSpring {
    /// Energy, force and its slope at a length.
    pub fn pull(&self, length: f64) -> [f64; 3] {
        linear(self.constant, length - self.rest)
    }
}

/// A spring that measures something else of a few points, an angle, an area, a volume, a coupling, a user's measure, or one with
/// a law of its own.
#[derive(Debug, Clone)]
pub struct MeasureSpring {
    pub kind: SpringKind,
    pub points: Vec<usize>,
    /// In J per square of the measure's unit: of an area N/m³, of a volume N/m⁵, of an angle N·m.
    pub constant: f64,
    /// The measure at rest, m², m³, rad, …
    pub rest: f64,
    pub measure: Measure,
    /// Where the force is not `constant · (c − rest)`; the constant is its slope at rest then.
    pub law: Option<Arc<Law>>,
    /// Of the law.
    pub parameters: Vec<f64>,
}

impl MeasureSpring {
    /// One that measures c at rest, with the slope k and the force T there, for which [`is_steady`] holds.
    fn steady(kind: SpringKind, points: Vec<usize>, measure: Measure, c: f64, [k, t]: [f64; 2]) -> MeasureSpring {
        let (law, parameters) = (Some(steady_law()), vec![t, k]);
        MeasureSpring { kind, points, constant: k, rest: c, measure, law, parameters }
    }

    /// Energy, force and its slope where the measure is c.
    pub fn pull(&self, c: f64) -> [f64; 3] {
        match &self.law {
            None => linear(self.constant, c - self.rest),
            Some(law) => [
                law.energy(c, self.rest, &self.parameters),
                law.force(c, self.rest, &self.parameters),
                law.slope(c, self.rest, &self.parameters),
            ],
        }
    }

    /// The force of [`MeasureSpring::pull`] alone; the energy of a law is an integral.
    pub fn tension(&self, c: f64) -> f64 {
        match &self.law {
            None => linear(self.constant, c - self.rest)[1],
            Some(law) => law.force(c, self.rest, &self.parameters),
        }
    }
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
        let (lengths, steady) = merge(mesh, fits);
        network.lengths = lengths;
        network.others = lawful(mesh, fits);
        network.others.extend(steady);
        network.others.extend(mesh.blocks.iter().zip(fits).flat_map(|(block, fit)| others(mesh, block, fit)));
        network
    }

    /// The tangent stiffness at rest, `Σ_s k_s g_s g_sᵀ`, N/m; `points` as in the mesh, `[points × dimension]`.
    pub fn stiffness(&self, points: &[f64]) -> Entries {
        let d = self.dimension;
        let mut entries = Entries::new();
        for spring in &self.lengths {
            let [i, j] = spring.points;
            let (xi, xj) = (&points[i * d..(i + 1) * d], &points[j * d..(j + 1) * d]);
            let length = distance(xi, xj);
            let n: Vec<f64> = xi.iter().zip(xj).map(|(a, b)| (b - a) / length).collect();
            // (1 − L₀/ℓ) I + (L₀/ℓ) n nᵀ: n nᵀ of springs that do not pull at rest.
            let along = spring.rest / length;
            for k in 0..d {
                for l in 0..d {
                    let across = if k == l { 1.0 - along } else { 0.0 };
                    let value = spring.constant * (across + along * n[k] * n[l]);
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
            let [_, pull, slope] = spring.pull(spring.measure.value(&x, d));
            // Springs that do not pull at rest need no second derivatives.
            let bend = if pull == 0.0 { Vec::new() } else { spring.measure.jet(&x, d).hessian };
            for (a, row) in dofs(&spring.points, d).enumerate() {
                for (b, column) in dofs(&spring.points, d).enumerate().filter(|(_, column)| row >= *column) {
                    let bent = bend.get(a * x.len() + b).map_or(0.0, |h| pull * h);
                    entries.push(Triplet::new(row, column, slope * gradient[a] * gradient[b] + bent));
                }
            }
        }
        entries
    }

    /// The network whose springs pull `factors` times as hard, `[springs]`, lengths first. Of a law the parameters that the force
    /// is proportional to are scaled.
    pub fn scaled(&self, factors: &[f64]) -> Network {
        let mut network = self.clone();
        let (lengths, others) = factors.split_at(network.lengths.len());
        network.lengths.iter_mut().zip(lengths).for_each(|(s, factor)| s.constant *= factor);
        for (spring, factor) in network.others.iter_mut().zip(others) {
            spring.constant *= factor;
            let outer = spring.law.iter().flat_map(|law| law.outer());
            spring.parameters.iter_mut().zip(outer).filter(|(_, outer)| **outer).for_each(|(p, _)| *p *= factor);
        }
        network
    }

    pub fn len(&self) -> usize {
        self.lengths.len() + self.others.len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The largest constant of a length spring, as a multiple of the least.
    pub fn range(&self) -> f64 {
        let constants = || self.lengths.iter().map(|s| s.constant);
        constants().fold(0.0, f64::max) / constants().fold(f64::INFINITY, f64::min)
    }

    /// How many constants are below zero.
    pub fn negative(&self) -> usize {
        self.negative_springs().count()
    }

    /// The `count` springs that push hardest where they should pull: their points and constants, the least first.
    pub fn most_negative(&self, count: usize) -> Vec<(&[usize], f64)> {
        let mut springs: Vec<(&[usize], f64)> = self.negative_springs().collect();
        springs.sort_by(|a, b| a.1.total_cmp(&b.1));
        springs.truncate(count);
        springs
    }

    fn negative_springs(&self) -> impl Iterator<Item = (&[usize], f64)> {
        let lengths = self.lengths.iter().map(|s| (&s.points[..], s.constant));
        lengths.chain(self.others.iter().map(|s| (&s.points[..], s.constant))).filter(|(_, k)| *k < 0.0)
    }
}

/// The springs of one block that measure more than a length, each cell's for itself.
fn others(mesh: &Mesh, block: &CellBlock, fit: &CellFits) -> Vec<MeasureSpring> {
    let (d, springs) = (mesh.dimension, &fit.springs);
    let (m, first) = (springs.len(), springs.pairs().len());
    let every: Vec<usize> = (0..springs.nodes()).collect();
    let function = |f: &FunctionSpring| Measure::Function(f.in_space.as_ref().unwrap_or(&f.function).clone());
    let functions = springs.functions().iter().map(|f| (f.kind, &f.nodes, function(f)));
    let of_cell = |kind: SpringKind| match springs.space() == springs.dimension() {
        true => Measure::Content(block.element.clone()),
        false => {
            let formula = Measure::of_kind(kind, springs.nodes(), d);
            Measure::Function(Arc::new(formula.expect("the area of a facet has a formula in any space")))
        }
    };
    let content = springs.content().map(|kind| (kind, &every, of_cell(kind)));
    let kinds: Vec<(SpringKind, &Vec<usize>, Measure)> = functions.chain(content).collect();
    let mut all = Vec::new();
    if kinds.is_empty() {
        return all;
    }
    let places = fit.force.places(springs.groups());
    let count = places[m];
    for (cell, (nodes, constants)) in block.cells().zip(fit.constants.chunks_exact(m)).enumerate() {
        for (s, (kind, own, measure)) in (first..).zip(&kinds) {
            let constant = constants[s];
            let parameters = &fit.parameters[cell * count..][places[s]..places[s + 1]];
            let idle = match &fit.force {
                Force::Laws(laws) => is_idle(&laws[springs.groups()[s]], parameters),
                _ => constant == 0.0 && parameters.iter().all(|p| *p == 0.0),
            };
            if idle {
                continue;
            }
            let points: Vec<usize> = own.iter().map(|&a| nodes[a]).collect();
            let mut x = vec![0.0; points.len() * d];
            gather(&mesh.points, d, &points, &mut x);
            let now = measure.value(&x, d);
            let pull = if matches!(fit.force, Force::FreeRest) { constant * now - parameters[0] } else { 0.0 };
            if is_steady(constant, pull, now) {
                all.push(MeasureSpring::steady(*kind, points, measure.clone(), now, [constant, pull]));
                continue;
            }
            let (law, rest) = match &fit.force {
                Force::Linear => (None, now),
                Force::FreeRest => (None, parameters[0] / constant),
                Force::Laws(laws) => (Some(laws[springs.groups()[s]].clone()), now),
            };
            let parameters = if law.is_some() { parameters.to_vec() } else { Vec::new() };
            all.push(MeasureSpring { kind: *kind, points, constant, rest, measure: measure.clone(), law, parameters });
        }
    }
    all
}

/// The length springs of the blocks whose force is a law, those between the same two points added up where the law is linear in
/// its parameters.
fn lawful(mesh: &Mesh, fits: &[CellFits]) -> Vec<MeasureSpring> {
    let mut all: Vec<MeasureSpring> = Vec::new();
    let mut known: HashMap<([usize; 2], &str), usize> = HashMap::new();
    for (block, fit) in mesh.blocks.iter().zip(fits) {
        let Force::Laws(laws) = &fit.force else { continue };
        let m = fit.springs.len();
        let places = fit.force.places(fit.springs.groups());
        for (cell, nodes) in block.cells().enumerate() {
            for (s, &[a, b]) in fit.springs.pairs().iter().enumerate() {
                let at = cell * m + s;
                let parameters = &fit.parameters[cell * places[m]..][places[s]..places[s + 1]];
                let law = &laws[fit.springs.groups()[s]];
                if is_idle(law, parameters) {
                    continue;
                }
                let points = [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])];
                let next = all.len();
                let place = if law.is_linear() { *known.entry((points, &law.text)).or_insert(next) } else { next };
                if place < next {
                    all[place].constant += fit.constants[at];
                    all[place].parameters.iter_mut().zip(parameters).for_each(|(sum, p)| *sum += p);
                    continue;
                }
                all.push(MeasureSpring {
                    kind: SpringKind::Length,
                    points: points.to_vec(),
                    constant: fit.constants[at],
                    rest: distance(mesh.point(points[0]), mesh.point(points[1])),
                    measure: Measure::Length,
                    law: Some(law.clone()),
                    parameters: parameters.to_vec(),
                });
            }
        }
    }
    all
}

/// Whether a law never pulls with these parameters.
fn is_idle(law: &Law, parameters: &[f64]) -> bool {
    law.is_linear() && parameters.iter().all(|p| *p == 0.0)
}

/// Points whose springs one thread merges in one go.
const CHUNK: usize = 2048;

/// Adds up the length springs between the same two points. Each point goes through the cells around it and gathers the
/// springs to its higher neighbours in a list of its own, which is short: nothing is sorted or hashed as a whole. Those whose sum
/// has no rest length come apart from the others.
fn merge(mesh: &Mesh, fits: &[CellFits]) -> (Vec<LengthSpring>, Vec<MeasureSpring>) {
    let linear = mesh.blocks.iter().zip(fits).filter(|(_, fit)| !matches!(fit.force, Force::Laws(_)));
    let stars: Vec<Star> = linear.map(|(block, fit)| Star::new(mesh, block, fit)).collect();
    let count = mesh.point_count();
    let firsts: Vec<usize> = (0..count).step_by(CHUNK).collect();
    let part = |first: &usize| {
        let (mut springs, mut others) = (Vec::new(), Vec::new());
        let mut neighbours: Vec<Neighbour> = Vec::new();
        for i in *first..(first + CHUNK).min(count) {
            neighbours.clear();
            for star in &stars {
                star.gather(mesh, i, &mut neighbours);
            }
            neighbours.sort_unstable_by_key(|n| n.point);
            for n in neighbours.iter().filter(|n| n.constant != 0.0 || n.slack != 0.0) {
                let length = distance(mesh.point(i), mesh.point(n.point));
                if is_steady(n.constant, -n.slack, length) {
                    let points = vec![i, n.point];
                    let numbers = [n.constant, -n.slack];
                    others.push(MeasureSpring::steady(SpringKind::Length, points, Measure::Length, length, numbers));
                    continue;
                }
                let rest = rest_length(length, n.slack / n.constant);
                springs.push(LengthSpring { points: [i, n.point], constant: n.constant, rest });
            }
        }
        (springs, others)
    };
    let parts: Vec<(Vec<LengthSpring>, Vec<MeasureSpring>)> = firsts.par_iter().map(part).collect();
    let (springs, others): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
    (springs.concat(), others.concat())
}

/// The springs from a point to another so far.
struct Neighbour {
    point: usize,
    constant: f64,
    /// `Σ k (L₀ − ℓ)`, ℓ the distance: zero of springs at their rest length.
    slack: f64,
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
        for (s, &[a, b]) in fit.springs.pairs().iter().enumerate() {
            springs[a].push((s, b));
            springs[b].push((s, a));
        }
        Star { block, fit, starts, places, springs }
    }

    /// Adds the springs from point i to higher points; each point appears once in `neighbours`.
    fn gather(&self, mesh: &Mesh, i: usize, neighbours: &mut Vec<Neighbour>) {
        let (n, m) = (self.springs.len(), self.fit.springs.len());
        for &place in &self.places[self.starts[i]..self.starts[i + 1]] {
            let (cell, node) = (place / n, place % n);
            let nodes = &self.block.connectivity[cell * n..(cell + 1) * n];
            let constants = &self.fit.constants[cell * m..(cell + 1) * m];
            for &(s, other) in &self.springs[node] {
                let j = nodes[other];
                if j > i {
                    let slack = match self.fit.force {
                        Force::FreeRest => {
                            let length = distance(mesh.point(i), mesh.point(j));
                            self.fit.parameters[cell * m + s] - constants[s] * length
                        }
                        _ => 0.0,
                    };
                    match neighbours.iter_mut().find(|n| n.point == j) {
                        Some(n) => {
                            n.constant += constants[s];
                            n.slack += slack;
                        }
                        None => neighbours.push(Neighbour { point: j, constant: constants[s], slack }),
                    }
                }
            }
        }
    }
}
