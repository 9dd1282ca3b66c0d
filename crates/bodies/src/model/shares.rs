//! Springs between two points as sums of what their cells give: of all cells at once, or of some of them, whose sums are added later.

use super::network::{LengthSpring, MeasureSpring};
use super::steady::{is_steady, rest_length};
use crate::element::SpringKind;
use crate::fit::CellFits;
use crate::mesh::{CellBlock, Mesh};
use crate::springs::{Force, Measure, distance};
use rayon::prelude::*;
use smallvec::SmallVec;

/// What cells give to the spring between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthShare {
    /// The points, the lower index first.
    pub points: [usize; 2],
    /// `Σ k`, N/m.
    pub constant: f64,
    /// `Σ |k|`, N/m.
    pub size: f64,
    /// `Σ k (L₀ − ℓ)`, with ℓ the distance: zero for springs at their rest length, N.
    pub slack: f64,
}

/// What the shares of two points make.
#[derive(Debug, Clone)]
pub enum SharedSpring {
    /// No spring: the shares cancel.
    None,
    /// A spring with a rest length.
    Length(LengthSpring),
    /// A spring that pulls at rest as no rest length does.
    Steady(MeasureSpring),
}

/// A constant of an exact network whose terms cancel to this share of their sizes is a rounding error: there is no
/// spring.
const ROUNDING: f64 = 1e-13;

impl LengthShare {
    /// Adds the share of later cells in the same spring.
    #[inline(always)]
    pub fn add(&mut self, later: &LengthShare) {
        self.constant += later.constant;
        self.size += later.size;
        self.slack += later.slack;
    }

    /// The spring between points whose distance `length` gives, m, once all shares are added.
    #[inline(always)]
    pub fn spring(&self, length: impl FnOnce() -> f64, is_exact: bool) -> SharedSpring {
        let LengthShare { points, constant, size, slack } = *self;
        if constant == 0.0 && slack == 0.0 || is_exact && constant.abs() <= ROUNDING * size {
            return SharedSpring::None;
        }
        // Springs of an exact network have no rest length at all, not one that is nearly zero.
        if is_exact && slack == 0.0 {
            return SharedSpring::Length(LengthSpring { points, constant, rest: 0.0 });
        }
        let length = length();
        if is_steady(constant, -slack, length) {
            let kind = SpringKind::Length;
            let numbers = [constant, -slack];
            return SharedSpring::Steady(MeasureSpring::steady(
                kind,
                SmallVec::from_slice(&points),
                Measure::Length,
                length,
                numbers,
            ));
        }
        let rest = if is_exact { 0.0 } else { rest_length(length, slack / constant) };
        SharedSpring::Length(LengthSpring { points, constant, rest })
    }
}

/// Whether the fits are those of an exact network.
pub fn is_exact(fits: &[CellFits]) -> bool {
    !fits.is_empty() && fits.iter().all(|fit| matches!(fit.force, Force::Exact { .. }))
}

/// The shares of the cells of a mesh in the springs between two points, sorted by the points; `fits` has one entry per block. The shares in
/// a spring are one sum if `is_inside` one of its points, otherwise they follow each other in the order of the cells.
pub fn length_shares(mesh: &Mesh, fits: &[CellFits], is_inside: impl Fn(usize) -> bool + Sync) -> Vec<LengthShare> {
    let mut sums = Vec::new();
    let visit = |stars: &[Star], i: usize, shares: &mut Vec<LengthShare>, all: &mut Vec<LengthShare>| {
        for star in stars {
            star.gather(mesh, i, |j| is_inside(i) || is_inside(j), shares);
        }
        // A stable sort keeps the order of the cells.
        shares.sort_by_key(|share| share.points[1]);
        all.extend_from_slice(shares);
    };
    each_point(mesh, fits, visit, |part| sums.extend(part));
    sums
}

/// Adds the length springs between the same two points. For each point the cells around it are visited, and the springs
/// to its higher neighbours are gathered in a short list, so that nothing is sorted or hashed as a whole. Sums without
/// a rest length are returned separately.
pub(super) fn merge(mesh: &Mesh, fits: &[CellFits]) -> (Vec<LengthSpring>, Vec<MeasureSpring>) {
    let is_exact = is_exact(fits);
    let (mut springs, mut others) = (Vec::new(), Vec::new());
    let visit =
        |stars: &[Star], i: usize, shares: &mut Vec<LengthShare>, all: &mut (Vec<LengthSpring>, Vec<MeasureSpring>)| {
            for star in stars {
                star.gather(mesh, i, |_| true, shares);
            }
            // All shares of two points are one sum by now: no two are equal.
            shares.sort_unstable_by_key(|share| share.points[1]);
            for share in &*shares {
                match share.spring(|| distance(mesh.point(i), mesh.point(share.points[1])), is_exact) {
                    SharedSpring::None => {}
                    SharedSpring::Length(spring) => all.0.push(spring),
                    SharedSpring::Steady(spring) => all.1.push(spring),
                }
            }
        };
    let mut visited = 0;
    each_point(mesh, fits, visit, |part: (Vec<_>, Vec<_>)| {
        visited += CHUNK;
        let found = springs.len() + part.0.len();
        if found > springs.capacity() {
            // A list that grows is copied. The number of springs at the points that were visited tells how many there are at all points.
            let all = found.max(found.saturating_mul(mesh.point_count()) / visited);
            springs.reserve_exact(all + all / 16 - springs.len());
        }
        springs.extend(part.0);
        others.extend(part.1);
    });
    // A list that has grown holds up to twice its length.
    springs.shrink_to_fit();
    (springs, others)
}

/// The number of points that one thread visits at a time.
// In a tetrahedral mesh they have some 3 600 springs, beside which it takes no time to hand them to a thread.
const CHUNK: usize = 512;
/// The number of chunks whose results wait in memory to be taken: enough for many threads, and a small part of a large body.
const ROUND: usize = 64;

/// Runs `visit(stars, point, empty list, results)` for every point, on all threads. The results of each chunk of points are taken in
/// order.
fn each_point<T: Default + Send>(
    mesh: &Mesh,
    fits: &[CellFits],
    visit: impl Fn(&[Star], usize, &mut Vec<LengthShare>, &mut T) + Sync,
    mut take: impl FnMut(T),
) {
    let linear = mesh.blocks.iter().zip(fits).filter(|(_, fit)| !matches!(fit.force, Force::Laws(_)));
    let stars: Vec<Star> = linear.map(|(block, fit)| Star::new(mesh, block, fit)).collect();
    let count = mesh.point_count();
    let firsts: Vec<usize> = (0..count).step_by(CHUNK).collect();
    let part = |first: &usize| {
        // One list for all points of a chunk, whose memory is kept from point to point.
        let (mut shares, mut results) = (Vec::new(), T::default());
        for i in *first..(first + CHUNK).min(count) {
            shares.clear();
            visit(&stars, i, &mut shares, &mut results);
        }
        results
    };
    for round in firsts.chunks(ROUND) {
        // What threads find is taken in the order of the points: the result is the same on any number of threads.
        let parts: Vec<T> = round.par_iter().map(part).collect();
        parts.into_iter().for_each(&mut take);
    }
}

/// The cells of one block around each point.
struct Star<'a> {
    block: &'a CellBlock,
    fit: &'a CellFits,
    /// The index in `places` at which those of each point begin, `[points + 1]`.
    starts: Vec<usize>,
    /// Indices into the connectivity, grouped by their point.
    places: Vec<usize>,
    /// For each node of the cell its length springs: the spring, and the node at the other end.
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

    /// Adds the shares of the cells in the springs from point i to higher points. Those of points for which `joins` are one sum.
    #[inline(always)]
    fn gather(&self, mesh: &Mesh, i: usize, joins: impl Fn(usize) -> bool, shares: &mut Vec<LengthShare>) {
        let (n, m) = (self.springs.len(), self.fit.springs.len());
        for &place in &self.places[self.starts[i]..self.starts[i + 1]] {
            let (cell, node) = (place / n, place % n);
            let nodes = &self.block.connectivity[cell * n..(cell + 1) * n];
            let constants = &self.fit.constants[cell * m..(cell + 1) * m];
            for &(s, other) in &self.springs[node] {
                let j = nodes[other];
                // Each spring once, with its lower point.
                if j > i {
                    let slack = match self.fit.force {
                        Force::FreeRest => {
                            let length = distance(mesh.point(i), mesh.point(j));
                            self.fit.parameters[cell * m + s] - constants[s] * length
                        }
                        _ => 0.0,
                    };
                    let share = LengthShare { points: [i, j], constant: constants[s], size: constants[s].abs(), slack };
                    match shares.iter_mut().find(|sum| sum.points[1] == j && joins(j)) {
                        Some(sum) => sum.add(&share),
                        None => shares.push(share),
                    }
                }
            }
        }
    }
}
