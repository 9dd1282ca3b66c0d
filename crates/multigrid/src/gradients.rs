//! Conjugate gradients, preconditioned by the levels.

use crate::entry::{Entry, Lanes, beside, vector};
use crate::fault::{Fault, Motion};
use crate::hierarchy::{Multigrid, shown};
use crate::parallel::{PIECE, combine, dot, vectorized};
use crate::settings::{Event, Watch};
use crate::tridiagonal::Tridiagonal;
use rayon::prelude::*;

/// Iterations without a new least residual after which there is no hope. Residuals rise between falls, the longer the
/// farther apart the eigenvalues are.
const PATIENCE: usize = 60;
/// Times that the residual is worked out anew from the solution. The residual of a recurrence drifts away from the true
/// one, and each time takes the drift away.
const RESTARTS: usize = 4;
/// The square of the share of `‖ |A| |x| ‖` below which a residual is rounding: four units.
const ROUNDING: f64 = 16.0 * f64::EPSILON * f64::EPSILON;
/// So many right hand sides take less time side by side than one after another.
// Eight side by side take 1.8 to 2.5 times the time of one (docs/src/theory/multigrid.md), however many lanes are filled.
const WORTH: usize = 3;

/// A solution, and how it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// On all unknowns, zero in what is held.
    pub displacement: Vec<f64>,
    /// Iterations of the method.
    pub iterations: usize,
    /// `‖b − A x‖/‖b‖` on the unknowns that are not held, worked out anew from x.
    pub residual: f64,
    /// `√(rᵀ M⁻¹ r / bᵀ M⁻¹ b)` at the end, which is about the relative error in the norm of the energy.
    pub error: f64,
    /// The least and the largest eigenvalue of `M⁻¹ A` that the iteration has met.
    pub spectrum: [f64; 2],
}

/// The state of one right hand side.
struct Column {
    solution: Solution,
    /// `bᵀ M⁻¹ b`.
    scale: Option<f64>,
    /// `rᵀ M⁻¹ r`.
    along: f64,
    /// The least error, and its iteration.
    best: (f64, usize),
    lanczos: Lanczos,
    /// Whether its search has ended until the residual is computed anew.
    rests: bool,
    /// Whether its search has ended for good.
    is_done: bool,
}

impl Column {
    fn new() -> Column {
        let solution =
            Solution { displacement: Vec::new(), iterations: 0, residual: 0.0, error: 0.0, spectrum: [1.0, 1.0] };
        let (scale, lanczos) = Default::default();
        Column { solution, scale, along: 0.0, best: (f64::INFINITY, 0), lanczos, rests: false, is_done: false }
    }

    /// Begins a search from a residual worked out anew.
    fn begin(&mut self, along: f64, tolerance: f64) {
        let scale = *self.scale.get_or_insert(along);
        if !self.is_done && !(along > tolerance * tolerance * scale) {
            // A right-hand side of zeros has 0/0 here, which max turns into zero.
            self.solution.error = (along / scale).max(0.0).sqrt();
            self.is_done = true;
        }
        (self.along, self.rests, self.lanczos) = (along, self.is_done, Lanczos::default());
    }

    /// After a step: the share of the last direction in the next one.
    fn advance(&mut self, step: f64, next: f64, (tolerance, iterations): (f64, usize)) -> f64 {
        let (solution, ratio) = (&mut self.solution, next / self.along);
        self.lanczos.step(step, ratio);
        solution.iterations += 1;
        // Rounding can take the product of a small residual with its correction below zero.
        solution.error = (next / self.scale.unwrap_or(next)).max(0.0).sqrt();
        if solution.error < self.best.0 {
            self.best = (solution.error, solution.iterations);
        }
        let is_stalled = solution.iterations >= iterations || solution.iterations > self.best.1 + PATIENCE;
        // The comparison is negated so that an error that is not a number ends the search too.
        self.rests = !(solution.error > tolerance) || is_stalled || !next.is_finite();
        self.along = next;
        ratio
    }

    /// Ends a search.
    fn end(&mut self) {
        if let Some([low, high]) = self.lanczos.matrix.extremes() {
            let spectrum = &mut self.solution.spectrum;
            *spectrum = [spectrum[0].min(low), spectrum[1].max(high)];
        }
    }
}

impl<const D: usize, const M: usize> Multigrid<D, M> {
    /// `A x = b` on the unknowns that are not held, where x is zero, until `rᵀ M⁻¹ r ≤ tolerance² bᵀ M⁻¹ b` or the residual is rounding.
    ///
    /// # Errors
    /// A motion of the search has no energy above zero, the residual does not become less, the sizes do not agree, or the watch broke off.
    pub fn solve(&self, b: &[f64], tolerance: f64, iterations: usize, watch: &mut Watch) -> Result<Solution, Fault> {
        self.check(b)?;
        Ok(self.gradients::<f64>(&[b], tolerance, iterations, watch)?.remove(0))
    }

    /// Solves for each of several right hand sides as [`Multigrid::solve`] does, eight at a time: each product reads the matrix once for
    /// all of them. The watch hears the largest residual of those.
    ///
    /// # Errors
    /// As [`Multigrid::solve`].
    pub fn solve_each(
        &self,
        b: &[&[f64]],
        tolerance: f64,
        iterations: usize,
        watch: &mut Watch,
    ) -> Result<Vec<Solution>, Fault> {
        b.iter().try_for_each(|b| self.check(b))?;
        let mut all = Vec::with_capacity(b.len());
        for some in b.chunks(Lanes::COUNT) {
            if some.len() < WORTH {
                for one in some {
                    all.extend(self.gradients::<f64>(&[one], tolerance, iterations, watch)?);
                }
            } else {
                all.extend(self.gradients::<Lanes>(some, tolerance, iterations, watch)?);
            }
        }
        Ok(all)
    }

    fn check(&self, b: &[f64]) -> Result<(), Fault> {
        let expected = self.rows() * D;
        if b.len() != expected {
            return Err(Fault::Size { what: "the right hand side", expected, found: b.len() });
        }
        if b.iter().any(|x| !x.is_finite()) { Err(Fault::NotFinite) } else { Ok(()) }
    }

    /// Each right hand side has directions and steps of its own; a product is that of all of them.
    fn gradients<T: Entry>(
        &self,
        b: &[&[f64]],
        tolerance: f64,
        iterations: usize,
        watch: &mut Watch,
    ) -> Result<Vec<Solution>, Fault> {
        let mut room = self.rooms::<T>();
        let mut force: Vec<[T; D]> = beside(b);
        self.mask(&mut force);
        let zero = || vec![[T::ZERO; D]; self.rows()];
        let (mut x, mut z, mut p, mut ap) = (zero(), zero(), zero(), zero());
        let mut r = force.clone();
        let mut columns: Vec<Column> = b.iter().map(|_| Column::new()).collect();
        // Zero in lanes without a column.
        let lanes = |values: &[f64]| T::of_each(|lane| values.get(lane).copied().unwrap_or(0.0));
        let one = T::of_each(|_| 1.0);
        let wanted = dot(&force, &force);
        let (mut left, mut rounding) = (wanted, T::ZERO);
        for _ in 0..RESTARTS {
            self.cycle(&r, &mut z, &mut room);
            let along = dot(&r, &z);
            columns.iter_mut().enumerate().for_each(|(lane, column)| column.begin(along.lane(lane), tolerance));
            if columns.iter().all(|column| column.is_done) {
                break;
            }
            p.copy_from_slice(&z);
            while columns.iter().any(|column| !column.rests) {
                self.matrix().product(&p, &mut ap);
                let energy = dot(&p, &ap);
                let mut steps = vec![0.0; columns.len()];
                for (lane, column) in columns.iter().enumerate().filter(|(_, column)| !column.rests) {
                    // A positive definite matrix gives energy to every direction but zero, and a search without residual has ended before.
                    if !(energy.lane(lane) > 0.0) {
                        return Err(self.not_positive(&vector(&p, lane), energy.lane(lane)));
                    }
                    steps[lane] = column.along / energy.lane(lane);
                }
                let step = lanes(&steps);
                combine(&mut x, one, &p, step);
                combine(&mut r, one, &ap, T::ZERO - step);
                // The rows of what is held are in the matrix: their forces are reactions and no residual.
                self.mask(&mut r);
                self.cycle(&r, &mut z, &mut room);
                let next = dot(&r, &z);
                let mut ratios = vec![0.0; columns.len()];
                let mut heard = (0, 0.0_f64);
                for (lane, column) in columns.iter_mut().enumerate().filter(|(_, column)| !column.rests) {
                    ratios[lane] = column.advance(steps[lane], next.lane(lane), (tolerance, iterations));
                    heard = (heard.0.max(column.solution.iterations), heard.1.max(column.solution.error));
                }
                if watch(Event::Iteration { number: heard.0, residual: heard.1 }).is_break() {
                    return Err(Fault::Interrupted);
                }
                combine(&mut p, lanes(&ratios), &z, one);
            }
            columns.iter_mut().for_each(Column::end);
            // What rounding has taken from the residual.
            self.matrix().product(&x, &mut ap);
            r.copy_from_slice(&force);
            combine(&mut r, one, &ap, T::of_each(|_| -1.0));
            self.mask(&mut r);
            (left, rounding) = (dot(&r, &r), self.rounding(&x));
            for (lane, column) in columns.iter_mut().enumerate() {
                let is_rounding = left.lane(lane) <= ROUNDING * rounding.lane(lane);
                column.is_done |= is_rounding || column.solution.iterations >= iterations;
            }
            if columns.iter().all(|column| column.is_done) {
                break;
            }
        }
        let end = |(lane, Column { mut solution, .. }): (usize, Column)| {
            let [wanted, left, rounding] = [wanted, left, rounding].map(|square| square.lane(lane));
            solution.residual = if wanted > 0.0 { (left / wanted).sqrt() } else { 0.0 };
            // Both comparisons are negated, so that a solution that is not a number has stalled.
            if !(solution.error <= tolerance) && !(left <= ROUNDING * rounding) {
                let (residual, iterations, levels) = (solution.residual, solution.iterations, self.levels().to_vec());
                return Err(Fault::Stalled { residual, iterations, levels });
            }
            solution.displacement = vector(&x, lane).into_flattened();
            Ok(solution)
        };
        columns.into_iter().enumerate().map(end).collect()
    }

    /// `‖ |A| |x| ‖²`.
    fn rounding<T: Entry>(&self, x: &[[T; D]]) -> T {
        let a = self.matrix();
        let mut sizes = vec![[T::ZERO; D]; x.len()];
        // Each row is a sum of its own, so that threads do not change it.
        sizes.par_chunks_mut(PIECE).enumerate().for_each(|(piece, sizes)| {
            vectorized(
                #[inline(always)]
                || {
                    for (row, sizes) in (piece * PIECE..).zip(sizes) {
                        for at in a.pattern.starts[row]..a.pattern.starts[row + 1] {
                            let x = &x[a.pattern.columns[at] as usize];
                            for i in 0..D {
                                for j in 0..D {
                                    let product = x[j] * a.values[at][i][j];
                                    // The sizes of the products are what rounding is relative to: in their sum nothing cancels.
                                    sizes[i] += T::of_each(|lane| product.lane(lane).abs());
                                }
                            }
                        }
                    }
                },
            );
        });
        dot(&sizes, &sizes)
    }

    /// A motion without energy above zero, or numbers that are not finite.
    pub(crate) fn not_positive(&self, p: &[[f64; D]], energy: f64) -> Fault {
        if energy.is_nan() {
            return Fault::NotFinite;
        }
        let motion: Motion = shown(self.matrix(), p.to_vec());
        Fault::NotPositive(motion)
    }
}

/// The tridiagonal matrix of Lanczos' method from the numbers of conjugate gradients (Golub, Van Loan, Matrix Computations, § 10.2).
#[derive(Default)]
pub(crate) struct Lanczos {
    pub matrix: Tridiagonal,
    last: Option<[f64; 2]>,
}

impl Lanczos {
    /// The step α along a direction, and the ratio β of the residuals after and before it.
    pub fn step(&mut self, alpha: f64, beta: f64) {
        let carried = self.last.map_or(0.0, |[alpha, beta]| beta / alpha);
        self.matrix.diagonal.push(1.0 / alpha + carried);
        if let Some([alpha, beta]) = self.last {
            self.matrix.beside.push(beta.max(0.0).sqrt() / alpha);
        }
        self.last = Some([alpha, beta]);
    }
}
