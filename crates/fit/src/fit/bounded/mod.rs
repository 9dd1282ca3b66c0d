//! The quadratic programme `min ½ kᵀ M k − bᵀ k` under `k ≥ 0`, one element per lane.
//!
//! Block principal pivoting, in which the equations `M_FF k_F = b_F` of the constants F that are assumed positive are solved in all lanes at
//! once: by factors, or by conjugate gradients. The digits of a cell do not depend on the cells beside it.
//!
//! Theory: page *Least squares* of the book.

mod factors;
mod gradients;

pub use factors::Factors;
pub use gradients::{Gradients, Product};

use super::constrained::Exchanges;
use super::normal::slope_tolerance;
use crate::scalar::{Packed, vectorized};

/// The residual at which the signs of constants are judged, relative to b. Four digits show the sign of nearly every
/// constant, and a sign that is wrong all the same sends the lane back to judging.
const JUDGED: f64 = 1e-4;
/// The residual of the result, relative to b: a few rounding errors, so that no digit of a constant depends on the
/// iteration.
const SOLVED: f64 = 1e-15;

/// The equations of any set of constants, in the scaling `M_st scale_s scale_t`, in which all diagonal entries of M are equal.
pub trait Equations<T> {
    /// Whether residuals are rounding errors whatever the limits.
    const EXACT: bool;

    fn scale(&self) -> &[T];

    /// Solves `M_FF k_F = b_F` until the squares of the residuals are below the limits, in lanes whose limit is finite; false if that does
    /// not end, or the equations are singular.
    fn solve(&mut self, state: &mut State<T>, limits: &T) -> bool;
}

/// One element per lane; all lists have the shape `[unknowns]`.
pub struct State<T> {
    rhs: Vec<T>,
    /// 1 for constants that are assumed positive, 0 for others.
    free: Vec<T>,
    /// Zero where `free` is.
    constants: Vec<T>,
    /// `b − M k`
    rest: Vec<T>,
}

/// Replaces the constants of these lanes, the optimum without bounds, by the optimum under `k ≥ 0`. False, with nothing changed, if the
/// equations are not solved or the exchanges do not end.
pub fn bound<T: Packed>(equations: &mut impl Equations<T>, rhs: &[T], k: &mut [T], lanes: &[usize]) -> bool {
    let any = k[0].zero();
    vectorized!(any, {
        let room = || vec![any.clone(); rhs.len()];
        let mut scaled = room();
        for ((scaled, b), scale) in scaled.iter_mut().zip(rhs).zip(equations.scale()) {
            *scaled = b.clone() * scale;
        }
        let state = State { rhs: scaled, free: room(), constants: room(), rest: room() };
        let mut search = Search { equations, state };
        if !search.run(k, lanes) {
            return false;
        }
        for ((k, found), scale) in k.iter_mut().zip(&search.state.constants).zip(search.equations.scale()) {
            let found = found.clone() * scale;
            lanes.iter().for_each(|&lane| k.as_mut_slice()[lane] = found.as_slice()[lane]);
        }
        true
    })
}

struct Search<'a, T, E> {
    equations: &'a mut E,
    state: State<T>,
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

impl<T: Packed, E: Equations<T>> Search<'_, T, E> {
    /// Finds the optimum of these lanes from the signs of the constants `k`.
    #[inline(always)]
    fn run(&mut self, k: &[T], lanes: &[usize]) -> bool {
        let mut all: Vec<Own> = lanes.iter().map(|&lane| self.own(k, lane)).collect();
        // A residual beside a number that is not finite would never be below its limit.
        if !all.iter().all(|own| own.square.is_finite()) {
            return false;
        }
        loop {
            // Lanes wait until all are judged, so that what takes long is done for all of them.
            let is_judging = all.iter().any(|own| own.stage == Stage::Judging);
            let (stage, part) = if is_judging { (Stage::Judging, JUDGED) } else { (Stage::Judged, SOLVED) };
            let mut present: Vec<&mut Own> = all.iter_mut().filter(|own| own.stage == stage).collect();
            if present.is_empty() {
                return true;
            }
            let mut limits = k[0].constant(&f64::INFINITY);
            // The residual of b = 0 is zero, which a limit of zero would not exceed.
            present
                .iter()
                .for_each(|own| limits.as_mut_slice()[own.lane] = (part * part * own.square).max(f64::MIN_POSITIVE));
            if !self.equations.solve(&mut self.state, &limits) || !present.iter_mut().all(|own| self.judge(own)) {
                return false;
            }
        }
    }

    fn own(&mut self, k: &[T], lane: usize) -> Own {
        let positive: Vec<bool> = k.iter().map(|k| k.as_slice()[lane] >= 0.0).collect();
        for (s, (k, scale)) in k.iter().zip(self.equations.scale()).enumerate().filter(|(s, _)| positive[*s]) {
            self.state.free[s].as_mut_slice()[lane] = 1.0;
            self.state.constants[s].as_mut_slice()[lane] = k.as_slice()[lane] / scale.as_slice()[lane];
        }
        let b = || self.state.rhs.iter().map(|b| b.as_slice()[lane]);
        let tolerance = slope_tolerance::<f64>(b().fold(0.0f64, |largest, b| largest.max(b.abs())));
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
        // Numbers that are not finite are never right.
        let is_wrong = |s: &usize| match own.exchanges.positive[*s] {
            true => !(value(&self.state.constants, *s) >= 0.0),
            false => !(value(&self.state.rest, *s) <= own.tolerance),
        };
        let wrong: Vec<usize> = (0..self.state.rhs.len()).filter(is_wrong).collect();
        if wrong.is_empty() {
            // Factors leave nothing to refine, whereas an iteration that was ended early goes on to all digits once its signs are right.
            own.stage = if own.stage == Stage::Judging && !E::EXACT { Stage::Judged } else { Stage::Ended };
            return true;
        }
        own.stage = Stage::Judging;
        let Some(exchanged) = own.exchanges.exchange(&wrong) else { return false };
        // A constant that leaves is zero, and one that enters begins there.
        for &s in exchanged {
            self.state.free[s].as_mut_slice()[lane] = f64::from(u8::from(own.exchanges.positive[s]));
            self.state.constants[s].as_mut_slice()[lane] = 0.0;
        }
        true
    }
}
