//! One cell of a sampled fit: its forces and those of its springs at every shape, summed to normal equations.

use super::placed::{Placed, ShapeForces};
use super::sampling::Part;
use super::sets::Sets;
use super::settings::{SampledFit, Weights};
use super::shapes::Drawing;
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::fit::dense::inner;
use crate::fit::normal::Normal;
use crate::material::State;
use crate::springs::{Force, Law, Measure, Springs, distance};
use crate::stiffness::{Geometry, Hyperelastic, gathered};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// The number of shapes that one thread sums. It is fixed, so that the order of the sums, and with it their rounding,
/// does not depend on the number of threads.
pub const BLOCK: usize = 256;
/// The number of such blocks before they are added to the rest, which bounds the memory of their sums.
pub const BLOCKS: usize = 16;
/// Numbers of equations that are stored before they are summed: a few hundred kilobytes.
const HELD: usize = 1 << 15;
/// The number of parameters of a spring for which no memory is allocated.
const FEW: usize = 8;
/// A strain that is nearly zero. Without this floor, a shape that hardly deforms has a force of nearly zero and, by
/// relative weights, counts more than all others.
const SLIGHT: f64 = 1e-3;
/// The rest measures of springs that have their own, relative to the measure at rest. A nonnegative sum of two springs,
/// one with each of these, is a spring with a rest measure in between.
pub const REST_RANGE: [f64; 2] = [0.5, 2.0];

/// One cell with the data of its fit.
pub struct SampledCell<'a> {
    springs: Vec<Spring>,
    /// The unknowns of each spring.
    unknowns: Vec<Range<usize>>,
    count: usize,
    /// The group of each spring.
    groups: &'a [usize],
    /// The largest number of unknowns of a spring.
    widest: usize,
    /// The `‖f‖²` of a strain below which forces count as those of no deformation.
    pub(super) least_square: f64,
    pub(super) geometry: &'a Geometry,
    energy: &'a dyn Hyperelastic,
    state: State,
    drawing: Drawing<'a>,
    trained: Sets<'a>,
    held_out: Sets<'a>,
    pub(super) fit: &'a SampledFit,
    /// Orthonormal coordinates of the nodes, `[dimension × nodes]`, which give the work of a force on homogeneous
    /// deformations. Empty if all forces count equally.
    affine: Vec<f64>,
}

struct Spring {
    nodes: Vec<usize>,
    measure: Measure,
    rest: f64,
}

/// The sums `Σ_q w_q Jᵀ J`, `Σ_q w_q Jᵀ r` and `Σ_q w_q ‖r‖²` so far, with J the derivative of the springs' forces in
/// the unknowns and r the missing force.
#[derive(Debug, Clone)]
pub struct Sums {
    pub normal: Normal,
    pub square: f64,
    /// `Σ_q w_q ‖f‖²`.
    pub size: f64,
    /// The number of shapes that have less of their deformation than was drawn.
    pub reduced: usize,
}

/// The forces of a cell at one shape, weighted as by [`SampledFit::higher`].
#[derive(Debug, Clone, Default)]
pub struct Sample {
    pub weight: f64,
    /// The force of the material, `[seen]`.
    pub force: Vec<f64>,
    /// `∇c` of each spring, `[springs × seen]`.
    pub gradients: Vec<f64>,
    /// c of each spring.
    pub measures: Vec<f64>,
}

impl<'a> SampledCell<'a> {
    pub fn new(
        element: &Arc<Element>,
        springs: &'a Springs,
        geometry: &'a Geometry,
        energy: &'a dyn Hyperelastic,
        state: State,
        fit: &'a SampledFit,
        drawing: Drawing<'a>,
    ) -> SampledCell<'a> {
        let d = element.dimension();
        let with_rest = |(nodes, measure): (Vec<usize>, Measure)| {
            let rest = measure.value(&gathered(drawing.rest, d, &nodes), d);
            Spring { nodes, measure, rest }
        };
        let mut unknowns: Vec<Range<usize>> = Vec::new();
        let (mut count, mut widest) = (0, 0);
        for (s, &group) in springs.groups().iter().enumerate() {
            let first = springs.groups()[..s].iter().position(|&g| g == group).filter(|_| fit.tied);
            let own = first.map_or(count..count + fit.columns(group), |first| unknowns[first].clone());
            count = count.max(own.end);
            widest = widest.max(own.len());
            unknowns.push(own);
        }
        SampledCell {
            unknowns,
            count,
            groups: springs.groups(),
            widest,
            least_square: (SLIGHT * energy.young() * state.thickness() * geometry.content() / drawing.extent).powi(2),
            springs: springs.measures(element).into_iter().map(with_rest).collect(),
            geometry,
            energy,
            state,
            fit,
            affine: if fit.higher < 1.0 { coordinates(drawing.rest, d) } else { Vec::new() },
            drawing,
            trained: Sets::new(fit.sets(), drawing, Part::Trained),
            held_out: Sets::new(fit.sets(), drawing, Part::HeldOut),
        }
    }

    /// The shapes of a part.
    pub fn sets(&self, part: Part) -> &Sets<'a> {
        match part {
            Part::Trained => &self.trained,
            Part::HeldOut => &self.held_out,
        }
    }

    /// The number of unknowns of the fit.
    pub fn count(&self) -> usize {
        self.count
    }

    pub fn len(&self) -> usize {
        self.springs.len()
    }

    /// The measure of spring s at rest.
    pub fn rest(&self, s: usize) -> f64 {
        self.springs[s].rest
    }

    pub fn dimension(&self) -> usize {
        self.drawing.dimension
    }

    /// The group of spring s.
    pub fn group(&self, s: usize) -> usize {
        self.groups[s]
    }

    /// The places of the unknowns of spring s.
    pub fn places(&self, s: usize) -> Range<usize> {
        self.unknowns[s].clone()
    }

    /// The unknowns of spring s.
    pub fn of_spring<'p>(&self, s: usize, unknowns: &'p [f64]) -> &'p [f64] {
        &unknowns[self.unknowns[s].clone()]
    }

    /// The law of spring s, if it has one.
    pub fn law(&self, s: usize) -> Option<&Law> {
        if let Force::Laws(laws) = &self.fit.force { Some(&laws[self.groups[s]]) } else { None }
    }

    /// `of(law, parameter)` for every parameter of every law, unknown by unknown.
    pub fn each_parameter<T: Clone + Default>(&self, of: impl Fn(&Law, usize) -> T) -> Vec<T> {
        let mut all = vec![T::default(); self.count];
        for (s, own) in self.unknowns.iter().enumerate() {
            let Some(law) = self.law(s) else { continue };
            own.clone().enumerate().for_each(|(i, unknown)| all[unknown] = of(law, i));
        }
        all
    }

    /// The number of shapes of the part.
    pub fn shapes(&self, part: Part) -> usize {
        self.sets(part).count()
    }

    /// The sums over the shapes of one part, with J and r at `unknowns`.
    pub fn sums(&self, part: Part, unknowns: &[f64]) -> Result<Sums> {
        let total = self.shapes(part);
        let block = |first: usize| {
            let mut sums = Sums::of(self.count);
            let (mut sample, mut rows, mut lacking) = (Sample::default(), Vec::new(), Vec::new());
            let indices: Vec<usize> = (first..(first + BLOCK).min(total)).collect();
            for placed in self.placed(part, &indices)? {
                self.sample(&placed, &mut sample)?;
                self.equations(&sample, unknowns, &mut rows, &mut lacking);
                sums.size += sample.weight * inner(&sample.force, &sample.force);
                sums.reduced += usize::from(placed.is_reduced);
                if rows.len() > HELD {
                    sums.add(&mut rows, &mut lacking);
                }
            }
            sums.add(&mut rows, &mut lacking);
            Ok(sums)
        };
        let mut sums = Sums::of(self.count);
        for round in (0..total).step_by(BLOCK * BLOCKS) {
            let firsts: Vec<usize> = (round..total.min(round + BLOCK * BLOCKS)).step_by(BLOCK).collect();
            let parts: Vec<Result<Sums>> = firsts.into_par_iter().map(block).collect();
            for part in parts {
                sums.merge(&part?);
            }
        }
        Ok(sums)
    }

    /// The shapes of a part with these numbers.
    ///
    /// # Errors
    /// Those of [`ShapeForces::at`].
    pub fn placed(&self, part: Part, numbers: &[usize]) -> Result<Vec<Placed>> {
        let &SampledCell { geometry, energy, state, .. } = self;
        ShapeForces { sets: self.sets(part), geometry, energy, state }.at(numbers)
    }

    /// What the springs measure at a shape, and the forces there, weighted.
    ///
    /// # Errors
    /// A spring has no gradient there.
    pub fn sample(&self, placed: &Placed, sample: &mut Sample) -> Result<()> {
        let size = self.drawing.rest.len();
        let seen = self.seen();
        sample.force.resize(seen, 0.0);
        sample.force[..size].copy_from_slice(&placed.force);
        sample.gradients.clear();
        sample.gradients.resize(self.springs.len() * seen, 0.0);
        self.measure(&placed.x, sample);
        if sample.gradients.iter().chain(&sample.measures).any(|g| !g.is_finite()) {
            let problem = "what a spring measures has no finite gradient at a sampled shape";
            return Err(Error::new(problem).of_kind(ErrorKind::Infeasible));
        }
        std::iter::once(&mut sample.force[..])
            .chain(sample.gradients.chunks_exact_mut(seen))
            .for_each(|row| self.see(row));
        let weight = match self.fit.weights {
            Weights::Alike => 1.0,
            Weights::Relative => 1.0 / inner(&sample.force, &sample.force).max(self.least_square),
        };
        sample.weight = placed.share * weight;
        Ok(())
    }

    /// The number of values of a weighted force.
    pub fn seen(&self) -> usize {
        let d = self.drawing.dimension;
        self.drawing.rest.len() + if self.affine.is_empty() { 0 } else { d * d }
    }

    /// `f ↦ (h f, √(1 − h²) Cᵀ f)`, for which `‖·‖² = ‖(C Cᵀ + h H Hᵀ) f‖²`, with C the homogeneous deformations and H
    /// the others.
    fn see(&self, row: &mut [f64]) {
        if self.affine.is_empty() {
            return;
        }
        let (d, h) = (self.drawing.dimension, self.fit.higher);
        let (force, homogeneous) = row.split_at_mut(self.drawing.rest.len());
        let share = (1.0 - h * h).sqrt();
        for (l, coordinate) in self.affine.chunks_exact(force.len() / d).enumerate() {
            for k in 0..d {
                let along: f64 = coordinate.iter().zip(force.chunks_exact(d)).map(|(c, f)| c * f[k]).sum();
                homogeneous[l * d + k] = share * along;
            }
        }
        force.iter_mut().for_each(|f| *f *= h);
    }

    fn measure(&self, x: &[f64], sample: &mut Sample) {
        let (d, seen) = (self.drawing.dimension, self.seen());
        sample.measures.clear();
        for (spring, row) in self.springs.iter().zip(sample.gradients.chunks_exact_mut(seen)) {
            if let Measure::Length = spring.measure {
                let [i, j] = [spring.nodes[0] * d, spring.nodes[1] * d];
                let length = distance(&x[i..i + d], &x[j..j + d]);
                for k in 0..d {
                    let n = (x[j + k] - x[i + k]) / length;
                    (row[i + k], row[j + k]) = (-n, n);
                }
                sample.measures.push(length);
                continue;
            }
            let at = gathered(x, d, &spring.nodes);
            for (&a, g) in spring.nodes.iter().zip(spring.measure.gradient(&at, d).chunks_exact(d)) {
                row[a * d..(a + 1) * d].iter_mut().zip(g).for_each(|(row, g)| *row += g);
            }
            sample.measures.push(spring.measure.value(&at, d));
        }
    }

    /// The force of spring s with the measure c, at `unknowns`, and its derivatives in its parameters.
    fn pull(&self, s: usize, c: f64, unknowns: &[f64], slopes: &mut [f64]) -> f64 {
        let rest = self.springs[s].rest;
        let own = self.of_spring(s, unknowns);
        match &self.fit.force {
            Force::Linear => slopes[0] = c - rest,
            Force::FreeRest | Force::Exact { .. } => {
                slopes.iter_mut().zip(REST_RANGE).for_each(|(slope, share)| *slope = c - share * rest);
            }
            Force::Laws(laws) => {
                let law = &laws[self.groups[s]];
                law.by_parameter(c, rest, own, slopes);
                if !law.is_linear() {
                    return law.force(c, rest, own);
                }
            }
        }
        slopes.iter().zip(own).map(|(slope, p)| slope * p).sum()
    }

    /// The equations of one shape: `√w (f − Σ_s T_s ∇c_s)`, `[seen]`, and its negative derivatives in the unknowns,
    /// `[seen × unknowns]`; appended to the previous ones.
    pub fn equations(&self, sample: &Sample, unknowns: &[f64], rows: &mut Vec<f64>, lacking: &mut Vec<f64>) {
        let (seen, first, before) = (self.seen(), rows.len(), lacking.len());
        let scale = sample.weight.sqrt();
        rows.resize(first + seen * self.count, 0.0);
        lacking.extend(sample.force.iter().map(|f| scale * f));
        let mut few = [0.0; FEW];
        let mut many = vec![0.0; if self.widest > FEW { self.widest } else { 0 }];
        for (s, (gradient, &c)) in sample.gradients.chunks_exact(seen).zip(&sample.measures).enumerate() {
            let own = self.unknowns[s].clone();
            let slopes = if own.len() <= FEW { &mut few[..own.len()] } else { &mut many[..own.len()] };
            let pull = scale * self.pull(s, c, unknowns, slopes);
            let places = gradient.iter().enumerate().filter(|(_, g)| **g != 0.0);
            for (place, g) in places {
                lacking[before + place] -= pull * g;
                let row = &mut rows[first + place * self.count..][own.clone()];
                row.iter_mut().zip(&*slopes).for_each(|(entry, slope)| *entry += scale * slope * g);
            }
        }
    }
}

impl Sums {
    pub fn of(count: usize) -> Sums {
        Sums { normal: Normal::new(vec![0.0; count * count], vec![0.0; count]), square: 0.0, size: 0.0, reduced: 0 }
    }

    /// Adds `AᵀA` to M, `Aᵀ r` to b and `‖r‖²` for some equations, which are then removed.
    fn add(&mut self, rows: &mut Vec<f64>, lacking: &mut Vec<f64>) {
        let (equations, count) = (lacking.len(), self.normal.rhs.len());
        if equations == 0 {
            return;
        }
        self.square += inner(lacking, lacking);
        let a = MatRef::from_row_major_slice(rows, equations, count);
        let gram = MatMut::from_row_major_slice_mut(&mut self.normal.gram, count, count);
        let (lower, all) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
        triangular::matmul(gram, lower, Accum::Add, a.transpose(), all, a, all, 1.0, Par::Seq);
        for (row, r) in rows.chunks_exact(count).zip(&*lacking) {
            self.normal.rhs.iter_mut().zip(row).for_each(|(b, entry)| *b += entry * r);
        }
        rows.clear();
        lacking.clear();
    }

    pub fn merge(&mut self, other: &Sums) {
        let add = |a: &mut [f64], b: &[f64]| a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        add(&mut self.normal.gram, &other.normal.gram);
        add(&mut self.normal.rhs, &other.normal.rhs);
        self.square += other.square;
        self.size += other.size;
        self.reduced += other.reduced;
    }

    /// `√(Σ w ‖r‖²/Σ w ‖f‖²)` after a step of the unknowns, for forces that are linear in them.
    pub fn error(&self, step: &[f64]) -> f64 {
        let left = self.square - self.normal.fall(step);
        // Rounding can make this negative; NaN stays NaN.
        if left < 0.0 { 0.0 } else { (left / self.size).sqrt() }
    }
}

/// The coordinates of the nodes relative to their mean, with the d columns made orthonormal; `[dimension × nodes]`.
fn coordinates(rest: &[f64], d: usize) -> Vec<f64> {
    let nodes = rest.len() / d;
    let x = DMatrix::from_fn(nodes, d, |a, k| rest[a * d + k]);
    let centred = DMatrix::from_fn(nodes, d, |a, k| x[(a, k)] - x.column(k).mean());
    centred.qr().q().as_slice().to_vec()
}
