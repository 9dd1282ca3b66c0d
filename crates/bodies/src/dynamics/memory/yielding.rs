//! How far a branch flows within a step at one material point.
//!
//! Theory: page *Springs that forget* of the book.

use super::decay::Decay;
use nalgebra::Matrix3;

/// The stresses that drive the flow of a step, Pa: with the integral x the state is `e^(−x) G_n + (γ(x) − e^(−x)) H_n + (1 − γ(x)) H`, of which
/// F H Fᵀ and F_n H_n F_nᵀ have no deviator.
pub(super) struct Drive {
    before: Pair,
    after: Pair,
}

/// The squares `[P·P, P·Q, Q·Q]` of two deviators.
struct Pair([f64; 3]);

impl Pair {
    fn of([p, q]: [Matrix3<f64>; 2]) -> Pair {
        Pair([p.dot(&p), p.dot(&q), q.dot(&q)])
    }

    /// The von Mises stress of `a P + b Q`.
    fn stress(&self, a: f64, b: f64) -> f64 {
        let [pp, pq, qq] = self.0;
        // A square of a sum; rounding may leave it just below zero where both cancel.
        (1.5 * (a * a * pp + 2.0 * a * b * pq + b * b * qq)).max(0.0).sqrt()
    }
}

impl Drive {
    /// From `dev F_n G_n F_nᵀ` and `dev F_n H F_nᵀ` in the shape at the start, and `dev F (G_n − H_n) Fᵀ` and `dev F H_n Fᵀ` in that at the end, as stresses.
    pub fn new(before: [Matrix3<f64>; 2], after: [Matrix3<f64>; 2]) -> Drive {
        Drive { before: Pair::of(before), after: Pair::of(after) }
    }

    /// The von Mises stress of that state in the shape at the start and in that at the end.
    fn stresses(&self, x: f64) -> [f64; 2] {
        let Decay { left, mean, .. } = Decay::new(x, 1.0);
        [self.before.stress(left, 1.0 - mean), self.after.stress(left, mean)]
    }
}

/// A yield stress, Pa, and the length of the step over the relaxation time.
pub(super) struct Yield {
    pub limit: f64,
    pub steps: f64,
}

/// Halvings of an interval, down to rounding.
const HALVINGS: usize = 60;
/// Passes in which x and what drives the flow are found from each other.
// Each pass gains an order in the step: the second has that of the rule, and the third keeps its error beside that of the rule small.
const PASSES: usize = 3;

impl Yield {
    /// The integral x of r/τ over the step. A change of shape changes the stress q evenly, by the mean of what it does to the state at the start and to
    /// that at the end; flow takes `(q − σ_y)/τ` of it while q is above σ_y. This gives q at the end, and x is that whose state has it: exact
    /// where the shape is held, and of the second order.
    pub fn flow(&self, drive: &Drive) -> f64 {
        let [start, trial] = drive.stresses(0.0);
        let mut x = 0.0;
        for _ in 0..PASSES {
            let [before, after] = drive.stresses(x);
            let end = self.end(start, start + (trial - start + after - before) / 2.0);
            let of = |x: f64| drive.stresses(x)[1];
            // Flow only ever lowers the stress: an end that is not below the elastic one is rounding.
            let Some(end) = end.filter(|end| *end < trial) else { return 0.0 };
            // r is at most one, so that x is at most h/τ.
            x = if of(self.steps) >= end { self.steps } else { root(self.steps, end, of) };
        }
        x
    }

    /// q at the end; `None` if nothing flows.
    fn end(&self, start: f64, trial: f64) -> Option<f64> {
        let y = self.limit;
        let rate = trial - start;
        // What of the step has gone when flow begins.
        // Below σ_y the stress rises evenly to it. A stress that does not rise gives an infinite, negative or undefined
        // share.
        let elastic = if start >= y { 0.0 } else { (y - start) / rate };
        if !(elastic < 1.0) || start.max(trial) <= y {
            return None;
        }
        let (start, after) = (start.max(y), (1.0 - elastic) * self.steps);
        let driven = rate * (1.0 - elastic);
        let beyond = |share: f64| {
            let decay = Decay::new(share * after, 1.0);
            (start - y) * decay.left + share * driven * decay.mean
        };
        if beyond(1.0) >= 0.0 {
            return Some(y + beyond(1.0));
        }
        // It was unloaded below σ_y within the step.
        let share = bisect(0.0, 1.0, |share| beyond(share) > 0.0);
        Some(y + (1.0 - share) * driven)
    }
}

/// The place where a condition ends.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The place from 0 to `high` where a function that falls has a value, by the rule of the false position, with the half of a value that stays (Illinois).
fn root(high: f64, value: f64, of: impl Fn(f64) -> f64) -> f64 {
    let mut ends = [(0.0, of(0.0) - value), (high, of(high) - value)];
    let mut last = None;
    for _ in 0..HALVINGS {
        let [(low, above), (high, below)] = ends;
        let x = (low * below - high * above) / (below - above);
        let off = of(x) - value;
        // The value or the place is the wanted one to rounding.
        if off.abs() <= f64::EPSILON * value || high - low <= f64::EPSILON * high {
            return x;
        }
        let side = usize::from(off < 0.0);
        ends[side] = (x, off);
        if last.replace(side) == Some(side) {
            ends[1 - side].1 /= 2.0;
        }
    }
    let [(low, _), (high, _)] = ends;
    0.5 * (low + high)
}
