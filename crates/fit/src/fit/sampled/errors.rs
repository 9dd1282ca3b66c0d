//! The errors of the springs' forces, shape by shape and family by family.
//!
//! Theory: page *Sampled fits* of the book.

use super::block::SIDE;
use super::cell::{BLOCK, BLOCKS, REST_RANGE, Sample, SampledCell};
use super::placed::Placed;
use super::sampling::Part;
use crate::error::Result;
use crate::fit::dense::inner;
use crate::springs::{AskedResponse, Force};
use rayon::prelude::*;
use springfit_numerics::dense::singular;

/// The error of the springs' forces at one shape of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ShapeError {
    /// The cell, from 0 in its block; cells that are its translation have the same errors.
    pub cell: usize,
    /// Whether the fit sees the shape.
    pub part: Part,
    /// The set of shapes, from 0 among those of the part.
    pub set: usize,
    /// The number of the shape in its set, from 0.
    pub shape: usize,
    /// The name of the family, `listed` of a list of gradients, or `states`.
    pub family: &'static str,
    /// The least det F over the quadrature points.
    pub content: f64,
    /// The least and the largest principal stretch over the quadrature points.
    pub stretches: [f64; 2],
    /// `‖f‖`, N; forces that do no work on homogeneous deformations are scaled as by the fit.
    pub force: f64,
    /// `‖f − K‖/‖f‖`, with f the force of a small strain where it is less.
    pub error: f64,
}

/// The errors at the shapes of one family, or of a list.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FamilyErrors {
    /// The name of the family, `listed` of a list of gradients, or `states`.
    pub family: &'static str,
    /// The number of shapes, that of the cell with the most.
    pub shapes: usize,
    /// `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` over the shapes of the family, `[cells]`; NaN of cells without them, and infinite where the springs have
    /// no finite force at one.
    pub errors: Vec<f64>,
}

/// The sums over the shapes of a family: their number, `Σ w ‖f − K‖²` and `Σ w ‖f‖²`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FamilySums {
    pub family: &'static str,
    pub shapes: usize,
    square: f64,
    size: f64,
}

impl FamilySums {
    pub fn error(&self) -> f64 {
        relative(self.square, self.size)
    }
}

/// The root of a ratio; infinite if the springs have no finite force, and NaN if the shapes have none.
fn relative(square: f64, size: f64) -> f64 {
    // Forces that are not finite are worse than any error, and must not pass as one without shapes.
    if square.is_finite() { (square / size).sqrt() } else { f64::INFINITY }
}

/// The errors at all shapes of a part.
#[derive(Default)]
pub struct Evaluation {
    pub families: Vec<FamilySums>,
    pub shapes: Vec<ShapeError>,
}

impl Evaluation {
    /// `√(Σ w ‖f − K‖²/Σ w ‖f‖²)`.
    pub fn error(&self) -> f64 {
        let sum = |of: fn(&FamilySums) -> f64| self.families.iter().map(of).sum::<f64>();
        relative(sum(|family| family.square), sum(|family| family.size))
    }

    fn add(&mut self, sums: FamilySums) {
        match self.families.iter_mut().find(|known| known.family == sums.family) {
            Some(known) => {
                known.shapes += sums.shapes;
                known.square += sums.square;
                known.size += sums.size;
            }
            None => self.families.push(sums),
        }
    }
}

impl SampledCell<'_> {
    /// The errors at the shapes of a part; those of each shape are kept if `data` is wanted.
    ///
    /// # Errors
    /// Those of [`SampledCell::placed`] and [`SampledCell::sample`].
    pub fn evaluate(&self, part: Part, unknowns: &[f64], data: bool) -> Result<Evaluation> {
        let total = self.shapes(part);
        let mut all = Evaluation::default();
        for round in (0..total).step_by(BLOCK * BLOCKS) {
            // The parts are added in the order of the shapes, so that sums are the same on any number of threads.
            let firsts: Vec<usize> = (round..total.min(round + BLOCK * BLOCKS)).step_by(BLOCK).collect();
            let block = |first: usize| self.evaluate_some(part, first..(first + BLOCK).min(total), unknowns, data);
            let parts: Vec<Result<Evaluation>> = firsts.into_par_iter().map(block).collect();
            for found in parts {
                let found = found?;
                found.families.into_iter().for_each(|sums| all.add(sums));
                all.shapes.extend(found.shapes);
            }
        }
        Ok(all)
    }

    fn evaluate_some(
        &self,
        part: Part,
        numbers: std::ops::Range<usize>,
        unknowns: &[f64],
        data: bool,
    ) -> Result<Evaluation> {
        let placed = self.placed(part, &numbers.clone().collect::<Vec<_>>())?;
        let seen = self.seen();
        let mut samples = vec![Sample::default(); placed.len()];
        placed.iter().zip(&mut samples).try_for_each(|(placed, sample)| self.sample(placed, sample))?;
        let mut left: Vec<Vec<f64>> = samples.iter().map(|sample| sample.force.clone()).collect();
        for s in 0..self.len() {
            let measures: Vec<f64> = samples.iter().map(|sample| sample.measures[s]).collect();
            for ((left, sample), pull) in left.iter_mut().zip(&samples).zip(self.pulls(s, measures, unknowns)) {
                let gradient = &sample.gradients[s * seen..(s + 1) * seen];
                left.iter_mut().zip(gradient).for_each(|(left, g)| *left -= pull * g);
            }
        }
        let mut all = Evaluation::default();
        for (((number, placed), sample), left) in numbers.zip(&placed).zip(&samples).zip(&left) {
            let place = self.sets(part).at(number);
            let (square, size) = (inner(left, left), inner(&sample.force, &sample.force));
            let family = place.shapes.kind(place.index);
            let weight = sample.weight;
            all.add(FamilySums { family, shapes: 1, square: weight * square, size: weight * size });
            if data {
                let (content, stretches) = self.strains(placed);
                let (force, error) = (size.sqrt(), relative(square, size.max(self.least_square)));
                let (set, shape) = (place.set, place.index);
                all.shapes.push(ShapeError { cell: 0, part, set, shape, family, content, stretches, force, error });
            }
        }
        Ok(all)
    }

    /// The forces of spring s with these measures.
    fn pulls(&self, s: usize, mut measures: Vec<f64>, unknowns: &[f64]) -> Vec<f64> {
        let (rest, own, count) = (self.rest(s), self.of_spring(s, unknowns), measures.len());
        let sum = |c: &f64, shares: &[f64]| own.iter().zip(shares).map(|(k, share)| k * (c - share * rest)).sum();
        match &self.fit.force {
            Force::Linear => measures.iter().map(|c| sum(c, &[1.0])).collect(),
            Force::FreeRest | Force::Exact { .. } => measures.iter().map(|c| sum(c, &REST_RANGE)).collect(),
            Force::Laws(_) => {
                let Some(law) = self.law(s) else { return vec![0.0; count] };
                // Lanes without a shape repeat the last one.
                measures.resize(count.next_multiple_of(SIDE), measures[count - 1]);
                let values = 1 + own.len() + own.len() * (own.len() + 1) / 2;
                let mut wanted = vec![false; values];
                wanted[0] = true;
                let mut all = vec![0.0; values * measures.len()];
                let one = AskedResponse { c: &measures, rest, parameters: own, wanted, results: &mut all };
                law.respond_all::<SIDE>(&mut [one]);
                all.truncate(count);
                all
            }
        }
    }

    /// The least det F, and the least and the largest principal stretch, over the quadrature points.
    fn strains(&self, placed: &Placed) -> (f64, [f64; 2]) {
        let mut all = Vec::new();
        // Inverted points are measured too: the limit is for shapes that a fit may see.
        self.geometry.deformations(&placed.x, f64::NEG_INFINITY, &mut all);
        let d = self.dimension();
        let (mut content, mut stretches) = (f64::INFINITY, [f64::INFINITY, 0.0f64]);
        for f in &all {
            content = content.min(f.determinant());
            let Some(own) = singular(f.view((0, 0), (d, d)).into_owned()) else { return (f64::NAN, [f64::NAN; 2]) };
            stretches = [stretches[0].min(own.values.min()), stretches[1].max(own.values.max())];
        }
        (content, stretches)
    }
}
