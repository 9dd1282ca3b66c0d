//! The objectives that require R itself, for one element or one per lane.
//!
//! Theory: pages *The 2-norm* and *The divergence* of the book.

use super::bounded_divergence::settle;
use super::constrained::{bounded_optimum, solve_nonnegative, solve_precisely};
use super::dense::{factorize, inner, row_products};
use super::divergence::Divergence;
use super::normal::{Normal, Rank};
use super::objective::Objective;
use super::reduction::{Reduced, Source};
use super::settings::Fit;
use super::spectral::{AMBIGUOUS, EXACT, GAP, Optimum, Problem, Spectral, least_frobenius, refine};
use super::weight::{MotionWeight, Route};
use crate::scalar::{Real, vectorized};
use crate::springs::Springs;

/// If a motion is softer than this, relative to the stiffest motion, the squares in the normal equations have lost half
/// of the digits of `f64`.
const SOFTEST: f64 = 1e-4;

/// A pivot of the normal equations below this means a loss of more than seven digits.
const LEAST_PIVOT: f64 = 1e-6;
/// A pivot below this means that too many digits are lost, for every objective, if springs measure functions, whose gradients have lost
/// some digits before.
pub(super) const LEAST_MEASURED_PIVOT: f64 = 1e-4;
/// The softest motion is known to nine digits if its stiffness is this many rounding errors.
const KNOWN: f64 = 1e9;

/// The largest part of a gap that may be rounding of the constants: of an optimum of zero, 1e-12 of ‖R‖.
const ROUNDED: f64 = 1e-6;

/// The largest number of doublings of the part of a value that is the rounding of the constants.
const TRIALS: usize = 100;

/// The value and the bound of a spectral fit, in N/m (of the weighted matrix). Together they prove how close it is to
/// the optimum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// `‖W (R − K) W‖₂` is at most this.
    pub value: f64,
    /// No constants reach less than this.
    pub bound: f64,
    /// Whether other constants reach the same value; then these have the least Frobenius error among them. Not
    /// determined if constants are bounded.
    pub ambiguous: bool,
    /// `‖R‖`, to which the gap of a nearly vanishing value is relative.
    size: f64,
    /// How much of the value the rounding of the constants to `f64` can be, N/m, where that was determined.
    rounding: f64,
}

impl Certificate {
    /// `(value − bound)/value`; relative to a millionth of ‖R‖ if the value is smaller than that.
    pub fn gap(&self) -> f64 {
        (self.value - self.bound) / self.scale()
    }

    /// The part of the gap that may be rounding of the constants, at most 1e-6.
    pub fn rounding(&self) -> f64 {
        (self.rounding / self.scale()).min(ROUNDED)
    }

    fn scale(&self) -> f64 {
        self.value.max(EXACT * self.size)
    }

    /// Whether the gap is as small as it is asked to be. A bound that is above the value by more than that proves nothing: rounding
    /// has spoilt one of the two.
    fn is_closed(&self) -> bool {
        self.gap().abs() <= GAP + self.rounding()
    }
}

/// The reduced element and the working memory of the solver.
#[derive(Debug, Clone)]
pub struct Method<T> {
    reduced: Reduced<T>,
    weight: MotionWeight,
    nonnegative: bool,
    /// Whether springs measure functions.
    measures: bool,
    solver: ReducedSolver<T>,
}

/// What solves a fit on the reduced matrices.
#[derive(Debug, Clone)]
enum ReducedSolver<T> {
    LeastSquares { normal: Normal<T>, products: Vec<T> },
    Spectral(Box<Spectral<T>>),
    Divergence(Divergence<T>),
}

/// The outcome of one cell.
#[derive(Debug, Clone, Copy)]
pub struct Verdict {
    pub certificate: Option<Certificate>,
    pub rank: Rank,
    /// Whether the iteration reached the requested accuracy.
    pub reached: bool,
    /// Whether the softest motion is so much softer than the stiffest that more digits are required.
    pub delicate: bool,
}

impl<T: Real> Method<T> {
    /// None for objectives that do not require the reduced element.
    pub fn like(any: &T, springs: &Springs, fit: &Fit) -> Option<Method<T>> {
        let Route::Reduced(weight) = fit.objective.route(springs.need_matrix()) else { return None };
        Some(Method::weighted(any, springs, fit, weight))
    }

    /// The method that reduces a matrix seen through this weight.
    pub fn weighted(any: &T, springs: &Springs, fit: &Fit, weight: MotionWeight) -> Method<T> {
        let reduced = Reduced::like(any, springs, fit.tied);
        let m = springs.len();
        let solver = match fit.objective {
            Objective::Frobenius(_) => {
                // The room serves the products of springs with each other first, and then their images under R.
                let products = vec![any.zero(); m * m.max(reduced.order)];
                ReducedSolver::LeastSquares { normal: Normal::default(), products }
            }
            Objective::Spectral(_) => {
                ReducedSolver::Spectral(Box::new(Spectral::like(any, &reduced, fit.nonnegative, fit.gap)))
            }
            Objective::Divergence(balance) => {
                ReducedSolver::Divergence(Divergence::like(any, &reduced, balance, fit.nonnegative))
            }
        };
        let measures = !springs.functions().is_empty();
        Method { reduced, weight, nonnegative: fit.nonnegative, measures, solver }
    }

    /// Solves for the element or the matrix with nodes at `x`; `measured` as [`Reduced::set`] requires it.
    pub fn solve(&mut self, springs: &Springs, x: &[T], source: Source<T>, measured: &[T]) {
        self.reduced.set(self.weight, springs, x, source, measured);
        let any = self.reduced.size.clone();
        match &mut self.solver {
            ReducedSolver::LeastSquares { normal, products } => {
                let (c, zero) = (self.reduced.scales.len(), any.zero());
                normal.gram.resize(c * c, zero.clone());
                let m = springs.len();
                self.reduced.gram(&mut products[..m * m], &mut normal.gram);
                normal.rhs.clear();
                normal.rhs.resize(c, zero);
                let (p, h) = (self.reduced.order, self.reduced.rows());
                row_products(h, &self.reduced.stiffness[..p * p], p, false, &mut products[..m * p]);
                vectorized!(any, {
                    for (s, &unknown) in self.reduced.unknowns.iter().enumerate() {
                        let row = s * p..(s + 1) * p;
                        normal.rhs[unknown] = normal.rhs[unknown].clone() + &inner(&h[row.clone()], &products[row]);
                    }
                });
            }
            ReducedSolver::Spectral(solver) => solver.solve(&self.reduced),
            ReducedSolver::Divergence(solver) => solver.solve(&self.reduced),
        }
    }

    /// The constants without bounds, `[springs]`, N/m; if there are several optima, the one that was found. None if
    /// springs are linearly dependent or an iteration did not converge.
    pub fn constants(mut self) -> Option<Vec<T>> {
        let kappa = match &mut self.solver {
            ReducedSolver::LeastSquares { normal, .. } => {
                if !normal.solve_to(T::epsilon()) {
                    return None;
                }
                &normal.rhs
            }
            ReducedSolver::Spectral(solver) => &solver.kappa,
            ReducedSolver::Divergence(solver) if solver.reached.exceeds(&solver.reached.zero()) => &solver.kappa,
            ReducedSolver::Divergence(_) => return None,
        };
        let constant = |unknown: &usize| kappa[*unknown].clone() * &self.reduced.scales[*unknown];
        Some(self.reduced.unknowns.iter().map(constant).collect())
    }

    /// The constants under `k ≥ 0`, `[springs]`, N/m, if the optimum has the same positive constants as `near`;
    /// `Some(None)` if its conditions do not hold. None if springs are linearly dependent, or if the optimum is proved
    /// in another way.
    pub fn bounded_constants(mut self, near: &[f64]) -> Option<Option<Vec<T>>> {
        let any = self.reduced.size.clone();
        let mut kappa = vec![any.zero(); self.reduced.scales.len()];
        for (&unknown, k) in self.reduced.unknowns.iter().zip(near) {
            kappa[unknown] = any.constant(k) / &self.reduced.scales[unknown];
        }
        let found = match &mut self.solver {
            ReducedSolver::LeastSquares { normal, .. } => {
                let near: Vec<f64> = kappa.iter().map(Real::rounded).collect();
                bounded_optimum(normal, &near)?
            }
            ReducedSolver::Divergence(solver) => {
                let Reduced { order, unknowns, .. } = &self.reduced;
                let set: Vec<bool> = kappa.iter().map(|k| k.rounded() > 0.0).collect();
                let is_optimal = settle(self.reduced.rows(), *order, unknowns, solver.balance, &mut kappa);
                let is_same = kappa.iter().zip(set).all(|(k, positive)| (k.rounded() > 0.0) == positive);
                (is_optimal && is_same).then_some(kappa)
            }
            ReducedSolver::Spectral(_) => return None,
        };
        let constant = |kappa: &Vec<T>, unknown: &usize| kappa[*unknown].clone() * &self.reduced.scales[*unknown];
        Some(found.map(|kappa| self.reduced.unknowns.iter().map(|unknown| constant(&kappa, unknown)).collect()))
    }

    /// Writes the constants as [`Method::finish`] does, for a method that solves a single cell in numbers of more digits than the constants
    /// have; `independent` tells whether the springs are linearly independent.
    pub fn finish_alone(mut self, independent: impl Fn() -> bool, constants: &mut [f64]) -> Verdict {
        // Motions as soft as rounding errors do not determine the constants.
        let is_known = self.reduced.softest.rounded() > KNOWN * T::epsilon();
        let mut verdict = Verdict { certificate: None, rank: Rank::Full, reached: is_known, delicate: false };
        if let ReducedSolver::LeastSquares { normal, .. } = &self.solver {
            // Relative weights make pivots as small as the softest motion; this does not affect the accuracy.
            // With linearly dependent springs small pivots are those of the dependence, which no weight excuses.
            let relative = self.weight.divides_by_stiffness() && independent();
            let rounding = if relative { T::epsilon() } else { T::given() };
            let (kappa, rank, pivot) = solve_precisely(normal, self.nonnegative, rounding);
            for (constant, &unknown) in constants.iter_mut().zip(&self.reduced.unknowns) {
                *constant = kappa[unknown] * self.reduced.scales[unknown].rounded();
            }
            verdict.rank = rank;
            // A pivot of less leaves fewer than nine digits, whatever the elimination calls regular.
            verdict.reached &= pivot > KNOWN * rounding.min(T::epsilon());
            return verdict;
        }
        if let ReducedSolver::Divergence(solver) = &mut self.solver
            && self.nonnegative
        {
            let Reduced { order, unknowns, .. } = &self.reduced;
            let is_settled = settle(self.reduced.rows(), *order, unknowns, solver.balance, &mut solver.kappa);
            solver.reached = solver.reached.constant(if is_settled { &1.0 } else { &-1.0 });
        }
        let found = self.finish(Real::rounded, || 1.0, constants);
        verdict = Verdict { reached: found.reached && is_known, ..found };
        let Some(mut certificate) = verdict.certificate else { return verdict };
        // The constants are rounded to the numbers that are stored. What value these reach is found by trial from a small
        // excess on, because the bound of the rounding is rarely attained.
        certificate.rounding = certificate.size * self.rounding(constants);
        let unit = f64::EPSILON * certificate.size;
        let most = 4.0 * self.reduced.order as f64 * unit;
        // The excess starts at no less than one unit, because twice zero is zero.
        let (reached, mut excess) = (certificate.value, certificate.rounding.max(unit).min(most));
        for _ in 0..TRIALS {
            certificate.value = reached + excess;
            if self.distance_from_optimum(constants, certificate.value).is_some() {
                break;
            }
            excess *= 2.0;
        }
        verdict.reached &= certificate.is_closed();
        verdict.certificate = Some(certificate);
        verdict
    }

    /// An upper bound of `‖Σ δ_s h_s h_sᵀ‖₂/‖R‖` if each constant is off by δ_s, half a unit in its last place.
    fn rounding(&self, constants: &[f64]) -> f64 {
        let (p, h) = (self.reduced.order, self.reduced.rows());
        let parts = self.reduced.unknowns.iter().zip(constants).enumerate().map(|(s, (&unknown, k))| {
            let row = &h[s * p..(s + 1) * p];
            (k / self.reduced.scales[unknown].rounded()).abs() * inner(row, row).rounded()
        });
        parts.sum::<f64>() * f64::EPSILON / 2.0
    }

    /// After a spectral solution: an upper bound of the distance of the constants from the optimum, relative to the
    /// value. It requires that they reach the stated `value` (N/m), which is proved here by the pivots of
    /// `value I ± (R − K)`.
    pub fn distance_from_optimum(&mut self, constants: &[f64], value: f64) -> Option<f64> {
        let ReducedSolver::Spectral(solver) = &self.solver else { return None };
        let (p, any) = (self.reduced.order, self.reduced.size.clone());
        let mut kappa = vec![any.zero(); self.reduced.scales.len()];
        for (&unknown, k) in self.reduced.unknowns.iter().zip(constants) {
            kappa[unknown] = any.constant(k) / &self.reduced.scales[unknown];
        }
        let value = any.constant(&value) / &any;
        let (mut e, mut pivots) = (vec![any.zero(); p * p], vec![any.zero(); p]);
        // Both `t I − E` and `t I + E` must be positive definite: the 2-norm is the larger of the two ends.
        for sign in [-1.0, 1.0] {
            self.reduced.residual(&kappa, &mut e);
            e.iter_mut().for_each(|entry| *entry = entry.clone().scaled(&sign));
            (0..p).for_each(|i| e[i * p + i] = e[i * p + i].clone() + &value);
            if !(factorize(&mut e, p, 0.0, &mut pivots).rounded() > 0.0) {
                return None;
            }
        }
        // An optimum of zero has no relative distance; it is relative to what counts as zero there.
        let floor = value.greatest(&any.constant(&EXACT));
        Some(((value - &solver.bound) / &floor).rounded())
    }

    /// Writes the constants of one lane, `[springs]`, N/m. `lane` reads a number of that lane, and `quality` measures
    /// its cell if needed.
    pub fn finish(&mut self, lane: impl Fn(&T) -> f64, quality: impl Fn() -> f64, constants: &mut [f64]) -> Verdict {
        // The comparison is negated so that a softness that is not a number asks for more digits.
        let delicate = !(lane(&self.reduced.softest) > SOFTEST);
        let mut verdict = Verdict { certificate: None, rank: Rank::Full, reached: true, delicate };
        let kappa: Vec<f64> = match &self.solver {
            ReducedSolver::LeastSquares { normal, .. } => {
                let all = |values: &[T]| values.iter().map(&lane).collect();
                let normal = Normal::new(all(&normal.gram), all(&normal.rhs));
                let mut eliminated = normal.clone();
                let (kappa, rank) = match self.nonnegative {
                    true => solve_nonnegative(&normal),
                    false if eliminated.solve_regular() => {
                        let least = if self.measures { LEAST_MEASURED_PIVOT } else { LEAST_PIVOT };
                        verdict.delicate |= eliminated.least_pivot() < least;
                        (eliminated.rhs, Rank::Full)
                    }
                    false => normal.solve(),
                };
                verdict.rank = rank;
                kappa
            }
            ReducedSolver::Spectral(solver) => {
                let size = lane(&self.reduced.size);
                let kappa = solver.kappa.iter().map(&lane).collect();
                let mut optimum = Optimum { kappa, value: lane(&solver.value), bound: lane(&solver.bound) };
                // Half of the digits is enough in numbers of more digits than `f64`.
                let is_enough = optimum.value - optimum.bound <= solver.gap * optimum.value.max(EXACT);
                let refines = T::epsilon() >= T::given() && !is_enough;
                // A nonnegative optimum stays in the middle of the optima, away from the bounds.
                // A large least curvature shows a single optimum, which spares the search for others.
                let doubtful = lane(&solver.curvature) < AMBIGUOUS && !self.nonnegative;
                let mut ambiguous = false;
                if refines || doubtful {
                    let problem = Problem::of(&self.reduced, solver, &lane, quality());
                    if refines {
                        refine(&problem, &mut optimum);
                    }
                    ambiguous = doubtful && least_frobenius(&problem, &mut optimum);
                }
                verdict.delicate |= self.measures && solver.least_pivot(&lane) < LEAST_MEASURED_PIVOT;
                // For an optimum of zero the gap is only rounding.
                verdict.delicate |= optimum.value <= EXACT;
                let Optimum { kappa, value, bound } = optimum;
                let certificate =
                    Certificate { value: size * value, bound: size * bound, ambiguous, size, rounding: 0.0 };
                verdict.reached = certificate.is_closed();
                verdict.certificate = Some(certificate);
                kappa
            }
            ReducedSolver::Divergence(solver) => {
                verdict.reached = lane(&solver.reached) > 0.0;
                verdict.delicate |= self.measures && solver.least_pivot(&lane) < LEAST_MEASURED_PIVOT;
                let mut kappa: Vec<f64> = solver.kappa.iter().map(&lane).collect();
                // Numbers of more digits have done this already.
                if self.nonnegative && T::epsilon() >= T::given() {
                    let rows: Vec<f64> = self.reduced.rows().iter().map(&lane).collect();
                    verdict.reached =
                        settle(&rows, self.reduced.order, &self.reduced.unknowns, solver.balance, &mut kappa);
                }
                kappa
            }
        };
        // More digits may reach it.
        verdict.delicate |= !verdict.reached;
        for (constant, &unknown) in constants.iter_mut().zip(&self.reduced.unknowns) {
            *constant = kappa[unknown] * lane(&self.reduced.scales[unknown]);
        }
        verdict
    }
}
