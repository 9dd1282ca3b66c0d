//! The quadratic programme `min ½ kᵀ M k − bᵀ k` under `k ≥ 0`: block principal pivoting, whose result is checked by
//! the optimality conditions. Singular problems have a solver of their own.
//!
//! Theory: page *Least squares* of the book.

use super::normal::{Normal, OPTIMALITY, Rank, slope_tolerance};
use super::singular::least_nonnegative;
use super::vectorized_normal::VectorizedNormal;
use crate::scalar::{Real, Scalar};

/// Solves by block principal pivoting (Júdice and Pires 1994; Kim and Park 2011): assume which constants are positive,
/// solve for them, and exchange those that violate `k ≥ 0` or `Mk − b ≥ 0`. If `M` is singular or the exchanges do not
/// end, the optimum of least norm in the scaling with a unit diagonal is found.
pub fn solve_nonnegative(normal: &Normal) -> (Vec<f64>, Rank) {
    normal.solve_determined(solve_scalable)
}

/// The optimum of equations in numbers of more digits, and the least pivot as defined by [`Normal::least_pivot`].
pub fn solve_precisely<T: Real>(normal: &Normal<T>, nonnegative: bool, rounding: f64) -> (Vec<f64>, Rank, f64) {
    let (near, mut free) = (normal.rounded(), normal.clone());
    if !free.solve_to(rounding) {
        if !nonnegative {
            // What is singular in more digits is so in `f64`, where eigenvalues decide what counts. They lose no
            // digits: the pivot of one says so.
            return (near.least_norm(), Rank::Deficient, 1.0);
        }
        return match solve_nonnegative(&near) {
            (k, Rank::Unsolved) => (k, Rank::Unsolved, 1.0),
            (k, _) => (k, Rank::Deficient, 1.0),
        };
    }
    let (k, pivot) = (free.rounded().rhs, free.least_pivot());
    // The objective is convex: an optimum without bounds that is within the bounds is the optimum with them.
    if !nonnegative || k.iter().all(|k| *k >= 0.0) {
        return (k, Rank::Full, pivot);
    }
    let (scaled, scale) = normal.scaled();
    match pivot_to(&scaled, rounding) {
        Some(k) => (k.iter().zip(&scale).map(|(k, scale)| (k.clone() * scale).rounded()).collect(), Rank::Full, pivot),
        None => {
            let (k, rank) = solve_nonnegative(&near);
            (k, rank, pivot)
        }
    }
}

/// The optimum in which the constants that are zero in `near` are zero, if it is the optimum under `k ≥ 0`; otherwise
/// `Some(None)`. None if the other constants are linearly dependent.
pub fn bounded_optimum<T: Real>(normal: &Normal<T>, near: &[f64]) -> Option<Option<Vec<T>>> {
    let (scaled, scale) = normal.scaled();
    let set: Vec<usize> = (0..near.len()).filter(|&s| near[s] > 0.0).collect();
    let mut free = scaled.restricted(&set);
    if !free.solve_to(T::epsilon()) {
        return None;
    }
    let mut k = vec![scaled.rhs[0].zero(); near.len()];
    set.iter().zip(&free.rhs).for_each(|(&s, value)| k[s] = value.clone());
    let tolerance = OPTIMALITY * scaled.largest();
    let slopes = scaled.gradient(&k);
    // These are the conditions of Karush, Kuhn and Tucker: they decide, not the way that led to this set.
    let is_optimal = k.iter().all(|k| k.rounded() >= 0.0)
        && slopes.iter().zip(near).all(|(slope, k)| *k > 0.0 || slope.rounded() >= -tolerance);
    Some(is_optimal.then(|| k.into_iter().zip(&scale).map(|(k, scale)| k * scale).collect()))
}

/// Unknowns from which on sums are taken eight terms at a time.
pub const MANY: usize = 24;

fn solve_scalable(normal: &Normal) -> (Vec<f64>, Rank) {
    if normal.size() >= MANY {
        return solve_vectorized(&mut VectorizedNormal::of_lanes(normal, &[0])[0], None);
    }
    let (scaled, scale) = normal.scaled();
    let (mut k, rank) = decided(pivot_to(&scaled, f64::given()), || scaled.clone());
    k.iter_mut().zip(&scale).for_each(|(k, s)| *k *= s);
    (k, rank)
}

/// The optimum of many unknowns, from their values without bounds if these are known.
pub fn solve_vectorized(equations: &mut VectorizedNormal, free: Option<&[f64]>) -> (Vec<f64>, Rank) {
    let positive = free.map_or(vec![true; equations.size()], |free| free.iter().map(|k| *k >= 0.0).collect());
    let tolerance = slope_tolerance::<f64>(equations.largest());
    let ended = exchange(positive, |positive| {
        let set: Vec<usize> = (0..positive.len()).filter(|&s| positive[s]).collect();
        if !equations.solve(&set, f64::given()) {
            return None;
        }
        let (k, slopes) = (equations.constants(), equations.slopes());
        let is_wrong = |s: &usize| if positive[*s] { k[*s] < 0.0 } else { slopes[*s] < -tolerance };
        Some((0..k.len()).filter(is_wrong).collect())
    });
    let (k, rank) = decided(ended.then(|| equations.constants().to_vec()), || equations.scaled());
    (equations.unscaled(&k), rank)
}

/// What pivoting has found, or the optimum of least norm of equations that are singular or whose exchanges did not end.
fn decided(pivoted: Option<Vec<f64>>, scaled: impl FnOnce() -> Normal) -> (Vec<f64>, Rank) {
    if let Some(k) = pivoted {
        return (k, Rank::Full);
    }
    let scaled = scaled();
    // Exchanges that do not end say nothing of the rank.
    let is_regular = scaled.clone().solve_regular();
    match least_nonnegative(&scaled) {
        Some(k) => (k, if is_regular { Rank::Full } else { Rank::Deficient }),
        // Zero keeps the bounds, and the rank tells that it is no optimum.
        None => (vec![0.0; scaled.size()], Rank::Unsolved),
    }
}

/// Pivoting for input data with the relative error `rounding`.
fn pivot_to<T: Real>(normal: &Normal<T>, rounding: f64) -> Option<Vec<T>> {
    let m = normal.size();
    let tolerance = slope_tolerance::<T>(normal.largest());
    let mut k = Vec::new();
    exchange(vec![true; m], |positive| {
        let set: Vec<usize> = (0..m).filter(|&s| positive[s]).collect();
        let mut free = normal.restricted(&set);
        if !free.solve_to(rounding) {
            return None;
        }
        k = vec![normal.rhs[0].zero(); m];
        set.iter().zip(&free.rhs).for_each(|(&s, value)| k[s] = value.clone());
        let slope = normal.gradient(&k);
        let is_wrong = |s: &usize| if positive[*s] { k[*s].rounded() < 0.0 } else { slope[*s].rounded() < -tolerance };
        Some((0..m).filter(is_wrong).collect())
    })
    .then_some(k)
}

/// The assumption which constants are positive, and the exchanges that improve it.
pub struct Exchanges {
    pub positive: Vec<bool>,
    fewest: usize,
    patience: u32,
    left: usize,
}

impl Exchanges {
    pub fn new(positive: Vec<bool>) -> Exchanges {
        let m = positive.len();
        // The numbers α = 3 and β = m + 1 are those of Kim and Park. Murty's rule ends, but it may visit very many
        // sets: a search that has no exchanges left is given to the solver of singular equations.
        Exchanges { positive, fewest: m + 1, patience: 3, left: 100 + 10 * m }
    }

    /// Exchanges unknowns of `wrong`, which names at least one, and returns them; None after too many exchanges.
    pub fn exchange<'a>(&mut self, wrong: &'a [usize]) -> Option<&'a [usize]> {
        self.left = self.left.checked_sub(1)?;
        // Exchange all as long as that helps; then only the last one, which cannot cycle (Murty 1974).
        if wrong.len() < self.fewest {
            (self.fewest, self.patience) = (wrong.len(), 3);
        } else if self.patience > 0 {
            self.patience -= 1;
        }
        let exchanged = if self.patience > 0 || wrong.len() < self.fewest { wrong } else { &wrong[wrong.len() - 1..] };
        exchanged.iter().for_each(|&s| self.positive[s] = !self.positive[s]);
        Some(exchanged)
    }
}

/// Exchanges what `wrong` names until it names none; false if the equations of a set are singular, for which `wrong` returns None, or if the
/// exchanges do not end.
fn exchange(positive: Vec<bool>, mut wrong: impl FnMut(&[bool]) -> Option<Vec<usize>>) -> bool {
    let mut exchanges = Exchanges::new(positive);
    loop {
        match wrong(&exchanges.positive) {
            None => return false,
            Some(wrong) if wrong.is_empty() => return true,
            Some(wrong) if exchanges.exchange(&wrong).is_none() => return false,
            Some(_) => {}
        }
    }
}
