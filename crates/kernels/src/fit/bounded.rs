//! The quadratic programme `min ½ kᵀ M k − bᵀ k` under `k ≥ 0`, one element per lane.
//!
//! Block principal pivoting, in which the equations `M_FF k_F = b_F` of the constants F that are assumed positive are solved by conjugate
//! gradients. Each lane takes its own steps, and waits when it has ended, so that the digits of a cell do not depend on the cells beside it.
//!
//! Theory: page *Least squares* of the book.

use super::constrained::{Exchanges, slope_tolerance};
use crate::scalar::Packed;

/// The residual at which the signs of constants are judged, and that of the result, relative to b.
const JUDGED: f64 = 1e-4;
const SOLVED: f64 = 1e-15;

/// The largest number of iterations between two exchanges. Well-conditioned equations take ten to thirty.
const ITERATIONS: usize = 200;

/// Products with M in the scaling `M_st scale_s scale_t`, in which all diagonal entries are equal.
pub trait Product<T> {
    fn scale(&self) -> &[T];

    /// Writes M times the vector into the image.
    fn multiply(&mut self, vector: &[T], image: &mut [T]);
}

/// Replaces the constants of these lanes, the optimum without bounds, by the optimum under `k ≥ 0`. False, with nothing changed, if the
/// iterations or the exchanges do not end.
pub fn bound<T: Packed>(product: impl Product<T>, rhs: &[T], k: &mut [T], lanes: &[usize]) -> bool {
    let any = k[0].zero();
    any.vectorize(
        #[inline(always)]
        || {
            let room = || vec![any.clone(); rhs.len()];
            let (mut scaled, constants) = (room(), room());
            for ((scaled, b), scale) in scaled.iter_mut().zip(rhs).zip(product.scale()) {
                *scaled = b.clone() * scale;
            }
            let (free, rest, direction, image) = (room(), room(), room(), room());
            let mut search = Search { product, rhs: scaled, free, constants, rest, direction, image };
            if !search.run(k, lanes) {
                return false;
            }
            for ((k, found), scale) in k.iter_mut().zip(&search.constants).zip(search.product.scale()) {
                let found = found.clone() * scale;
                lanes.iter().for_each(|&lane| k.as_mut_slice()[lane] = found.as_slice()[lane]);
            }
            true
        },
    )
}

/// One element per lane; all lists have the shape `[unknowns]`.
struct Search<T, P> {
    product: P,
    rhs: Vec<T>,
    /// 1 for constants that are assumed positive, 0 for others.
    free: Vec<T>,
    constants: Vec<T>,
    /// `b − M k`
    rest: Vec<T>,
    direction: Vec<T>,
    image: Vec<T>,
}

/// How far a lane is: its signs are being judged; they are right as far as can be judged; its constants are found.
#[derive(Clone, Copy, PartialEq)]
enum Stage {
    Judging,
    Judged,
    Ended,
}

/// One element, in its lane.
struct Own {
    lane: usize,
    stage: Stage,
    exchanges: Exchanges,
    /// `‖b‖²`
    square: f64,
    tolerance: f64,
}

impl<T: Packed, P: Product<T>> Search<T, P> {
    /// Finds the optimum of these lanes from the signs of the constants `k`.
    #[inline(always)]
    fn run(&mut self, k: &[T], lanes: &[usize]) -> bool {
        let mut all: Vec<Own> = lanes.iter().map(|&lane| self.own(k, lane)).collect();
        loop {
            // Lanes wait until all are judged, so that the long iterations are those of all lanes.
            let is_judging = all.iter().any(|own| own.stage == Stage::Judging);
            let (stage, part) = if is_judging { (Stage::Judging, JUDGED) } else { (Stage::Judged, SOLVED) };
            let mut present: Vec<&mut Own> = all.iter_mut().filter(|own| own.stage == stage).collect();
            if present.is_empty() {
                return true;
            }
            let mut limits = k[0].constant(&f64::INFINITY);
            present
                .iter()
                .for_each(|own| limits.as_mut_slice()[own.lane] = (part * part * own.square).max(f64::MIN_POSITIVE));
            if !self.iterate(&limits) || !present.iter_mut().all(|own| self.judge(own)) {
                return false;
            }
        }
    }

    fn own(&mut self, k: &[T], lane: usize) -> Own {
        let positive: Vec<bool> = k.iter().map(|k| k.as_slice()[lane] >= 0.0).collect();
        for (s, (k, scale)) in k.iter().zip(self.product.scale()).enumerate().filter(|(s, _)| positive[*s]) {
            self.free[s].as_mut_slice()[lane] = 1.0;
            self.constants[s].as_mut_slice()[lane] = k.as_slice()[lane] / scale.as_slice()[lane];
        }
        let b = || self.rhs.iter().map(|b| b.as_slice()[lane]);
        let tolerance = slope_tolerance(b().fold(0.0f64, |largest, b| largest.max(b.abs())));
        Own {
            lane,
            stage: Stage::Judging,
            exchanges: Exchanges::new(positive),
            square: b().map(|b| b * b).sum(),
            tolerance,
        }
    }

    /// Exchanges what is wrong; false if there were too many exchanges.
    fn judge(&mut self, own: &mut Own) -> bool {
        let lane = own.lane;
        let value = |values: &[T], s: usize| values[s].as_slice()[lane];
        let is_wrong = |s: &usize| match own.exchanges.positive[*s] {
            true => value(&self.constants, *s) < 0.0,
            false => value(&self.rest, *s) > own.tolerance,
        };
        let wrong: Vec<usize> = (0..self.rhs.len()).filter(is_wrong).collect();
        if wrong.is_empty() {
            own.stage = if own.stage == Stage::Judging { Stage::Judged } else { Stage::Ended };
            return true;
        }
        own.stage = Stage::Judging;
        let Some(exchanged) = own.exchanges.exchange(&wrong) else { return false };
        for &s in exchanged {
            self.free[s].as_mut_slice()[lane] = f64::from(u8::from(own.exchanges.positive[s]));
            self.constants[s].as_mut_slice()[lane] = 0.0;
        }
        true
    }

    /// Conjugate gradients in the constants that are free, until the squares of the residuals are below the limits; false if they do not end.
    #[inline(always)]
    fn iterate(&mut self, limits: &T) -> bool {
        let Search { product, rhs, free, constants, rest, direction, image } = self;
        let (m, zero) = (rhs.len(), limits.zero());
        product.multiply(constants, image);
        let mut square = zero.clone();
        for s in 0..m {
            rest[s] = rhs[s].clone() - &image[s];
            direction[s] = rest[s].clone() * &free[s];
            square = square.plus_product(&direction[s], &direction[s]);
        }
        for _ in 0..ITERATIONS {
            if limits.exceeds(&square) {
                return true;
            }
            // Lanes below their limit stay where they are.
            let above = square.clone() - limits;
            product.multiply(direction, image);
            let mut work = zero.clone();
            for s in 0..m {
                work = work.plus_product(&direction[s], &image[s]);
            }
            let step = above.choose(&(square.clone() / &work), &zero);
            let mut next = zero.clone();
            for s in 0..m {
                constants[s] = constants[s].clone().plus_product(&step, &direction[s]);
                rest[s] = rest[s].clone().minus_product(&step, &image[s]);
                let rest = rest[s].clone() * &free[s];
                next = next.plus_product(&rest, &rest);
            }
            let share = above.choose(&(next.clone() / &square), &zero);
            for s in 0..m {
                direction[s] = (rest[s].clone() * &free[s]).plus_product(&share, &direction[s]);
            }
            square = next;
        }
        false
    }
}
