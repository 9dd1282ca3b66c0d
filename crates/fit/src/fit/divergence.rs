//! The divergence `min_κ tr A + c tr A⁻¹ − (1 − c) log det A`, `A = R̂^(−1/2) K(κ) R̂^(−1/2)`: the energy of the
//! springs relative to that of the element.
//!
//! The problem is convex, and infinite where A is not positive definite, so that the springs of an element always
//! resist every deformation. c = 0 is Stein's loss (James and Stein 1961), whose optimum is too soft rather than too
//! stiff; c = 1 is symmetric in A and A⁻¹. With h_s in units of R̂, Newton's method needs only A⁻¹: the slope is
//! `h·h − (1 − c) h·A⁻¹h − c h·A⁻²h`, and the curvature is `(1 − c)(h_s·A⁻¹h_t)² + 2c (h_s·A⁻¹h_t)(h_s·A⁻²h_t)`.
//!
//! Theory: page *The divergence* of the book.

use super::dense::{
    FLOOR, add_outers, at_rounding, factorize, inner, invert, least_pivot, longest_step, row_products, solve, tie,
    trace,
};
use super::objective::Balance;
use super::reduction::Reduced;
use crate::scalar::{Real, vectorized};

/// The largest number of Newton steps. For nearly incompressible materials the stiffness of the content damps the first
/// steps, of which there can be hundreds.
const STEPS: usize = 1000;
/// The squared Newton decrement at which the next step leaves an error of 1e-10, relative to the scale of the problem.
const CLOSE: f64 = 1e-10;
/// A step goes at most this share of the way to where the first κ would be zero. Beyond it the barrier, which is
/// infinite at zero, would have to push κ back in the next step.
const TOWARDS_ZERO: f64 = 0.9;
/// The weight of the barrier that keeps constants positive, at the start and at the end. The end leaves constants that
/// should be zero at 1e-9 over their slope, which the module of the bounded divergence then takes to zero.
const BARRIER: [f64; 2] = [1e-1, 1e-9];

/// The working memory of the solver, and its result.
#[derive(Debug, Clone)]
pub struct Divergence<T> {
    /// The unknowns κ, `[unknowns]`.
    pub kappa: Vec<T>,
    /// Positive if the optimum was reached.
    pub reached: T,
    pub balance: Balance,
    nonnegative: bool,
    matrix: Vec<T>,
    pivots: Vec<T>,
    inverse: Vec<T>,
    images: Vec<T>,
    /// `h_s·A⁻¹h_t` and `h_s·A⁻²h_t`, lower triangles.
    products: [Vec<T>; 2],
    hessian: Vec<T>,
    hessian_pivots: Vec<T>,
    gradient: Vec<T>,
    step: Vec<T>,
    trial: Vec<T>,
    room: Vec<T>,
}

impl<T: Real> Divergence<T> {
    pub fn like(any: &T, reduced: &Reduced<T>, balance: Balance, nonnegative: bool) -> Divergence<T> {
        let (p, m, c) = (reduced.order, reduced.unknowns.len(), reduced.scales.len());
        let room = |size: usize| vec![any.zero(); size];
        Divergence {
            kappa: room(c),
            reached: any.zero(),
            balance,
            nonnegative,
            matrix: room(p * p),
            pivots: room(p),
            inverse: room(p * p),
            images: room(m * p),
            products: [room(m * m), room(m * m)],
            hessian: room(c * c),
            hessian_pivots: room(c),
            gradient: room(c),
            step: room(c),
            trial: room(c),
            room: room(p * p),
        }
    }

    /// The least pivot of the last Hessian in one lane, relative to its diagonal entry.
    pub fn least_pivot(&self, lane: impl Fn(&T) -> f64) -> f64 {
        least_pivot(&self.hessian, self.kappa.len(), &self.hessian_pivots, lane)
    }

    /// Solves for the element in `reduced`, which must be reduced with the weight `relative`, in every lane.
    pub fn solve(&mut self, reduced: &Reduced<T>) {
        let any = self.reached.clone();
        vectorized!(any, self.minimise(reduced));
    }

    #[inline(always)]
    fn minimise(&mut self, reduced: &Reduced<T>) {
        let (p, m, c) = (reduced.order, reduced.unknowns.len(), self.kappa.len());
        let h = reduced.rows();
        let one = self.reached.one();
        let zero = one.zero();
        let start = reduced.uniform();
        for i in 0..c {
            self.kappa[i] = start.clone();
            self.step[i] = zero.clone();
        }
        // The first trial is the start itself.
        let mut alpha = zero.clone();
        let mut barrier = one.constant(if self.nonnegative { &BARRIER[0] } else { &0.0 });
        let last = one.constant(if self.nonnegative { &BARRIER[1] } else { &0.0 });
        self.reached = zero.clone() - &one;
        // Stein's loss first: far from the optimum its Newton steps are long, and those of tr A⁻¹ are not.
        let full = one.constant(&self.balance.value());
        let mut balance = zero.clone();
        for _ in 0..STEPS {
            let mut inside = one.clone();
            for entry in &mut self.matrix {
                *entry = zero.clone();
            }
            for i in 0..c {
                self.trial[i] = self.kappa[i].clone().plus_product(&alpha, &self.step[i]);
                if self.nonnegative {
                    inside = inside.least(&self.trial[i]);
                }
            }
            add_outers(&mut self.matrix, h, p, &self.trial, &reduced.unknowns, 1.0);
            // A pivot that is only a rounding error does not count as positive.
            let definite =
                factorize(&mut self.matrix, p, 0.0, &mut self.pivots) - &one.constant(&at_rounding::<T>(FLOOR));
            inside = inside.least(&definite);
            for i in 0..c {
                self.kappa[i] = inside.choose(&self.trial[i], &self.kappa[i]);
            }
            invert(&self.matrix, p, &self.pivots, &mut self.room, &mut self.inverse);
            row_products(h, &self.inverse, p, false, &mut self.images);
            row_products(h, &self.images, p, true, &mut self.products[0]);
            row_products(&self.images, &self.images, p, true, &mut self.products[1]);
            let (log, inverse) = (one.clone() - &balance, balance.clone().scaled(&2.0));
            tie(
                &self.products[0],
                &self.products[1],
                &reduced.unknowns,
                c,
                c,
                &mut self.hessian,
                #[inline(always)]
                |a, b| a.clone() * &(log.clone() * a).plus_product(&inverse, b),
            );
            for entry in &mut self.gradient {
                *entry = zero.clone();
            }
            for (s, &unknown) in reduced.unknowns.iter().enumerate() {
                let row = &h[s * p..(s + 1) * p];
                let slope = inner(row, row).minus_product(&log, &self.products[0][s * m + s]);
                let slope = slope.minus_product(&inverse.clone().scaled(&0.5), &self.products[1][s * m + s]);
                self.gradient[unknown] = self.gradient[unknown].clone() + &slope;
            }
            if self.nonnegative {
                for i in 0..c {
                    let share = barrier.clone() / &self.trial[i];
                    self.gradient[i] = self.gradient[i].clone() - &share;
                    let diagonal = &mut self.hessian[i * c + i];
                    // The barrier −β ln κ has the slope −β/κ and the curvature β/κ².
                    *diagonal = diagonal.clone() + &(share / &self.trial[i]);
                }
            }
            // Springs that depend on each other leave directions without curvature: the floor takes them out of the step.
            factorize(&mut self.hessian, c, at_rounding::<T>(FLOOR), &mut self.hessian_pivots);
            for i in 0..c {
                self.trial[i] = self.gradient[i].negated();
            }
            solve(&self.hessian, c, &self.hessian_pivots, &mut self.trial);
            let decrement = inner(&self.trial, &self.gradient).negated();
            // Relative to the objective, which is large if the element is nearly flat.
            let size = one.clone().plus_product(&balance, &trace(&self.inverse, p).scaled(&(1.0 / p as f64)));
            let close = inside.choose(&(size.scaled(&CLOSE) - &decrement), &zero);
            // Tenths of the first weight meet the last one only up to rounding.
            let ended = close.choose(&(last.clone().scaled(&1.001) - &barrier), &zero);
            // If the barrier has ended (both weights are zero), this condition holds as well.
            let ended = if self.nonnegative { ended } else { close.clone() };
            let ended = (full.clone() - &balance).choose(&zero, &ended);
            let ended = self.reached.choose(&one, &ended);
            // The step at which the iteration is close enough leaves only rounding errors.
            // For the barrier −log det, with λ the decrement, a step of 1/(1 + λ) stays inside and decreases the
            // objective. From λ = ½ down a whole step does, after which λ₊ ≤ (λ/(1 − λ))² (Nesterov and Nemirovskii
            // 1994).
            // Rounding may leave a decrement below zero, which has no root.
            let length = one.clone() / &(one.clone() + &decrement.greatest(&zero).sqrt());
            let mut length = (one.constant(&0.25) - &decrement).choose(&one, &length);
            if self.nonnegative {
                length = length.least(&longest_step(&self.kappa, &self.trial).scaled(&TOWARDS_ZERO));
            }
            let moving = self.reached.choose(&zero, &inside.choose(&length, &one));
            for i in 0..c {
                self.step[i] = inside.choose(&self.trial[i], &self.step[i]);
            }
            // A lane that is outside tries half of its last step, while the others go on.
            alpha = inside.choose(&moving, &alpha.clone().scaled(&0.5));
            // A lane that has ended takes its last step in the next pass, so that the test stands before the line that ends lanes.
            if self.reached.exceeds(&zero) {
                break;
            }
            self.reached = ended.choose(&one, &self.reached);
            // Near its minimum for one weight of the barrier, the iteration goes on to a tenth of that weight.
            let near = one.constant(&0.3) - &decrement;
            let tighter = near.negated().choose(&barrier, &barrier.clone().scaled(&0.1).greatest(&last));
            barrier = inside.choose(&tighter, &barrier);
            balance = inside.choose(&near.choose(&full, &balance), &balance);
        }
    }
}
