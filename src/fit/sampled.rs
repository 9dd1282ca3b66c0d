//! Spring constants from the nodal forces of a hyperelastic element at many deformed shapes.
//!
//! With rest lengths as at rest a spring of constant one pulls with `φ_s(x) = (c_s(x) − c_s⁰) ∇c_s(x)`, so the fit
//! `min_k Σ_q ‖f(x_q) − Σ_s k_s φ_s(x_q)‖²` is linear least squares: `M_st = Σ_q φ_s·φ_t`, `b_s = Σ_q φ_s·f_q`. Both are added
//! up shape by shape; no shape is kept.

use super::constrained::solve_nonnegative;
use super::each_cell;
use super::normal::{Normal, Rank};
use crate::element::Element;
use crate::error::{Error, Result};
use crate::material::{Energy, State};
use crate::springs::{Measure, Springs};
use crate::stiffness::Geometry;
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::sync::Arc;

/// Cells in a row that one thread fits.
const CHUNK: usize = 8;
/// A shape whose deformation gradient has a smaller determinant is drawn again, at half the size.
const FLAT: f64 = 0.2;

/// The deformed shapes that a fit is made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// How many shapes to fit.
    pub shapes: usize,
    /// How many others to measure the error on.
    pub held_out: usize,
    /// The largest entry of `F − I`.
    pub stretch: f64,
    /// How far each node is moved besides, as a share of the element's size.
    pub perturbation: f64,
    pub seed: u64,
}

impl Default for Sampling {
    fn default() -> Sampling {
        Sampling { shapes: 300, held_out: 100, stretch: 0.3, perturbation: 0.05, seed: 1 }
    }
}

/// The constants of all cells.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SampledFits {
    /// `[cells × springs]`, as in [`super::CellFits`].
    pub constants: Vec<f64>,
    /// `√(Σ‖f − K‖²/Σ‖f‖²)` on the shapes of the fit, `[cells]`.
    pub trained: Vec<f64>,
    /// The same on the shapes that were held out.
    pub held_out: Vec<f64>,
    /// Cells whose shapes did not determine the springs.
    pub deficient: usize,
}

/// Fits every cell: `connectivity` is `[cells × nodes]` into `points`, `[points × dimension]`, m.
///
/// # Errors
/// A cell is tangled, the numbers of the sampling are out of range, or the cells are those of a surface or curve in space.
#[allow(clippy::too_many_arguments)]
pub fn fit_sampled(
    element: &Arc<Element>,
    springs: &Springs,
    points: &[f64],
    connectivity: &[usize],
    energy: &Energy,
    state: State,
    sampling: &Sampling,
    nonnegative: bool,
) -> Result<SampledFits> {
    sampling.check()?;
    if element.space() > element.dimension() {
        return Err(Error::new("the sampled fit is known for cells that fill their space"));
    }
    let n = element.nodes();
    let chunk = |(i, nodes): (usize, &[usize])| {
        let mut fits = SampledFits::default();
        let mut outcome = Ok(());
        each_cell(element, points, nodes, i * CHUNK, |_, x, geometry| {
            let cell = Cell { element, springs, x, geometry, energy, state, sampling };
            match cell.fit(nonnegative) {
                Ok(fit) => fits.push(fit),
                Err(error) => outcome = Err(error),
            }
        })?;
        outcome.map(|()| fits)
    };
    let parts: Vec<Result<SampledFits>> = connectivity.par_chunks(CHUNK * n).enumerate().map(chunk).collect();
    let mut all = SampledFits::default();
    for part in parts {
        let part = part?;
        all.constants.extend(part.constants);
        all.trained.extend(part.trained);
        all.held_out.extend(part.held_out);
        all.deficient += part.deficient;
    }
    Ok(all)
}

impl SampledFits {
    fn push(&mut self, (constants, rank, [trained, held_out]): (Vec<f64>, Rank, [f64; 2])) {
        self.constants.extend(constants);
        self.trained.push(trained);
        self.held_out.push(held_out);
        self.deficient += usize::from(rank == Rank::Deficient);
    }
}

impl Sampling {
    fn check(&self) -> Result<()> {
        if self.shapes == 0 {
            return Err(Error::expected("shapes", "at least one shape", 0));
        }
        for (key, value) in [("stretch", self.stretch), ("perturbation", self.perturbation)] {
            if !(0.0..=2.0).contains(&value) {
                return Err(Error::expected(key, "a share from 0 to 2", value));
            }
        }
        if self.stretch + self.perturbation == 0.0 {
            return Err(Error::expected("stretch", "shapes that differ from the one at rest", "none"));
        }
        Ok(())
    }
}

/// Points that fill the unit cube evenly, whatever their number: the fractional parts of `i α_k`, the α_k being inverse powers
/// of the root of `g^(d+1) = g + 1` (Roberts 2018), shifted by the seed.
struct Lattice {
    slopes: Vec<f64>,
    shifts: Vec<f64>,
}

impl Lattice {
    fn new(dimension: usize, seed: u64) -> Lattice {
        let mut g: f64 = 2.0;
        for _ in 0..64 {
            g = (1.0 + g).powf(1.0 / (dimension + 1) as f64);
        }
        let mut state = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let mut shift = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let shifts = (0..dimension).map(|_| shift()).collect();
        Lattice { slopes: (0..dimension).map(|k| g.powi(-(k as i32) - 1).fract()).collect(), shifts }
    }

    /// Coordinates in [-1, 1].
    fn point(&self, i: usize) -> impl Iterator<Item = f64> + '_ {
        self.slopes.iter().zip(&self.shifts).map(move |(a, s)| 2.0 * (s + i as f64 * a).fract() - 1.0)
    }
}

/// One cell with what its fit needs.
struct Cell<'a> {
    element: &'a Arc<Element>,
    springs: &'a Springs,
    /// At rest, `[nodes × dimension]`.
    x: &'a [f64],
    geometry: &'a Geometry,
    energy: &'a Energy,
    state: State,
    sampling: &'a Sampling,
}

impl Cell<'_> {
    /// The constants, and the errors on the shapes of the fit and on the others.
    fn fit(&self, nonnegative: bool) -> Result<(Vec<f64>, Rank, [f64; 2])> {
        let Sampling { shapes, held_out, seed, .. } = *self.sampling;
        let trained = self.accumulate(shapes, 2 * seed)?;
        let normal = Normal::new(trained.gram.clone(), trained.rhs.clone());
        let (k, rank) = if nonnegative { solve_nonnegative(&normal) } else { normal.solve() };
        let others = if held_out > 0 { self.accumulate(held_out, 2 * seed + 1)?.error(&k) } else { f64::NAN };
        let error = trained.error(&k);
        Ok((k, rank, [error, if held_out > 0 { others } else { error }]))
    }

    fn accumulate(&self, shapes: usize, seed: u64) -> Result<Sums> {
        let (d, size, m) = (self.element.dimension(), self.x.len(), self.springs.len());
        let lattice = Lattice::new(d * d + size, seed);
        let measures = self.measures();
        let extent = (self.geometry.content()).powf(1.0 / d as f64);
        let mut sums = Sums { gram: vec![0.0; m * m], rhs: vec![0.0; m], square: 0.0 };
        let (mut force, mut pulls) = (vec![0.0; size], vec![0.0; m * size]);
        for shape in 0..shapes {
            let mut drawn = false;
            for scale in (0..8).map(|halvings| 0.5f64.powi(halvings)) {
                let x = self.deformed(&lattice, shape, scale, extent);
                let solid = self.geometry.forces(self.energy, self.state, &x, &mut force);
                if solid && self.is_upright(&x) {
                    self.pull(&measures, &x, &mut pulls);
                    if pulls.iter().any(|p| !p.is_finite()) {
                        return Err(Error::new("what a spring measures has no finite gradient at a sampled shape"));
                    }
                    sums.add(&force, &pulls);
                    drawn = true;
                    break;
                }
            }
            if !drawn {
                return Err(Error::new("the sampled shapes are turned inside out: expected a smaller stretch"));
            }
        }
        Ok(sums)
    }

    /// `x = F X + δ`.
    fn deformed(&self, lattice: &Lattice, i: usize, scale: f64, extent: f64) -> Vec<f64> {
        let d = self.element.dimension();
        let numbers: Vec<f64> = lattice.point(i).map(|u| u * scale).collect();
        let (gradient, moves) = numbers.split_at(d * d);
        let place = |(a, x): (usize, &[f64])| -> Vec<f64> {
            let along = |k: usize| {
                let turned: f64 = (0..d).map(|l| self.sampling.stretch * gradient[k * d + l] * x[l]).sum();
                x[k] + turned + self.sampling.perturbation * extent * moves[a * d + k]
            };
            (0..d).map(along).collect()
        };
        self.x.chunks_exact(d).enumerate().flat_map(place).collect()
    }

    /// Whether no quadrature point has lost most of its volume.
    fn is_upright(&self, x: &[f64]) -> bool {
        let d = self.element.dimension();
        self.geometry.gradients.chunks_exact(x.len()).all(|grad| {
            let entry = |k: usize, l: usize| -> f64 {
                x.chunks_exact(d).zip(grad.chunks_exact(d)).map(|(x, g)| x[k] * g[l]).sum()
            };
            DMatrix::from_fn(d, d, entry).determinant() > FLAT
        })
    }

    /// Nodes, measure and value at rest of every spring.
    fn measures(&self) -> Vec<(Vec<usize>, Measure, f64)> {
        let d = self.element.dimension();
        let springs = self.springs;
        let lengths = springs.pairs.iter().map(|pair| (pair.to_vec(), Measure::Length));
        let functions = springs.functions.iter().map(|f| (f.nodes.clone(), Measure::Function(f.function.clone())));
        let content = springs.content.map(|_| ((0..springs.nodes).collect(), Measure::Content(self.element.clone())));
        let with_rest = |(nodes, measure): (Vec<usize>, Measure)| {
            let rest = measure.value(&gathered(self.x, d, &nodes), d);
            (nodes, measure, rest)
        };
        lengths.chain(functions).chain(content).map(with_rest).collect()
    }

    /// `φ_s`, `[springs × nodes·dimension]`.
    fn pull(&self, measures: &[(Vec<usize>, Measure, f64)], x: &[f64], pulls: &mut [f64]) {
        let d = self.element.dimension();
        pulls.fill(0.0);
        for ((nodes, measure, rest), row) in measures.iter().zip(pulls.chunks_exact_mut(x.len())) {
            if let Measure::Length = measure {
                let (a, b) = (&x[nodes[0] * d..][..d], &x[nodes[1] * d..][..d]);
                let length = crate::springs::distance(a, b);
                for k in 0..d {
                    let pull = (length - rest) * (b[k] - a[k]) / length;
                    row[nodes[0] * d + k] = -pull;
                    row[nodes[1] * d + k] = pull;
                }
                continue;
            }
            let at = gathered(x, d, nodes);
            let change = measure.value(&at, d) - rest;
            for (&a, g) in nodes.iter().zip(measure.gradient(&at, d).chunks_exact(d)) {
                row[a * d..(a + 1) * d].iter_mut().zip(g).for_each(|(row, g)| *row += change * g);
            }
        }
    }
}

fn gathered(x: &[f64], d: usize, nodes: &[usize]) -> Vec<f64> {
    nodes.iter().flat_map(|&a| &x[a * d..(a + 1) * d]).copied().collect()
}

/// The normal equations so far, and `Σ‖f‖²`.
struct Sums {
    gram: Vec<f64>,
    rhs: Vec<f64>,
    square: f64,
}

impl Sums {
    fn add(&mut self, force: &[f64], pulls: &[f64]) {
        let (m, size) = (self.rhs.len(), force.len());
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        self.square += dot(force, force);
        for s in 0..m {
            let row = &pulls[s * size..(s + 1) * size];
            self.rhs[s] += dot(row, force);
            for t in 0..=s {
                self.gram[s * m + t] += dot(row, &pulls[t * size..(t + 1) * size]);
            }
        }
    }

    /// `√(Σ‖f − Σ k φ‖²/Σ‖f‖²)`.
    fn error(&self, k: &[f64]) -> f64 {
        let m = k.len();
        let entry = |s: usize, t: usize| self.gram[s.max(t) * m + s.min(t)];
        let bent: f64 = (0..m * m).map(|i| k[i / m] * entry(i / m, i % m) * k[i % m]).sum();
        let work: f64 = self.rhs.iter().zip(k).map(|(b, k)| b * k).sum();
        ((self.square - 2.0 * work + bent).max(0.0) / self.square).sqrt()
    }
}
