//! Whether a matrix is positive definite, by Lanczos' method with the levels.

use crate::block::Block;
use crate::fault::{Fault, Motion};
use crate::gradients::Lanczos;
use crate::hierarchy::Multigrid;
use crate::parallel::{combine, dot};
use crate::random::Random;
use crate::settings::{Event, Watch};
use std::f64::consts::PI;

/// An eigenvalue of `M⁻¹ A` that is not above this is zero up to rounding.
// Rounding of the recurrence leaves some 1e-15 of the largest, which is about one. To prove a smaller one positive would take a
// million steps, as each lowers Chebyshev's bound by `e^(−2 √θ)`.
const NOTHING: f64 = 1e-10;
/// The largest eigenvalue of `M⁻¹ A` is at most this multiple of the largest that was met, and not below 1, which it is without rounding.
// After 32 steps the largest that was met has been 0.5 % too small (`END_STEPS` of `levels.rs`), a tenth of the margin.
const MARGIN: f64 = 1.05;
/// Steps between two looks at the eigenvalues.
// A search ends up to three steps late by it, among tens, and a fourth of the looks is left.
const LOOK: usize = 4;

/// What is known about the least eigenvalue of a matrix.
#[derive(Debug, Clone, PartialEq)]
pub enum Definiteness {
    /// No eigenvalue is zero or below it, but with a chance of `doubt`: that of a random vector which is so nearly orthogonal to the motion
    /// of such an eigenvalue that `iterations` steps do not find it.
    Positive {
        /// The chance of an eigenvalue at or below zero.
        doubt: f64,
        /// The steps of Lanczos' method.
        iterations: usize,
    },
    /// A motion without energy above zero, up to rounding.
    NotPositive {
        /// What shows it.
        motion: Motion,
        /// The steps of Lanczos' method.
        iterations: usize,
    },
    /// The steps were too few.
    Undecided {
        /// The least eigenvalue of `M⁻¹ A` that they met.
        least: f64,
        /// The chance of one at or below zero.
        doubt: f64,
        /// The steps of Lanczos' method.
        iterations: usize,
    },
}

impl<const D: usize, const M: usize> Multigrid<D, M> {
    /// Whether the matrix is positive definite on what is not held, with at most the chance `doubt` of a wrong "positive".
    ///
    /// A is positive definite if `M⁻¹ A` is (Sylvester's law), M the V-cycle, which is positive. Let its eigenvalues be at most c, θ the
    /// least Ritz value of k steps of Lanczos' method from `v = M^(−½) r`, and u a unit eigenvector of an eigenvalue that is not above zero.
    /// Chebyshev's polynomial of the degree k − 1 on [θ, c] in Rayleigh's quotient gives
    ///
    /// `(u·v)²/‖v‖² ≤ ε² = (c − θ) / (θ T²_(k−1)((c + θ)/(c − θ)))`
    ///
    /// (as in Kuczyński, Woźniakowski, SIAM J. Matrix Anal. Appl. 13, 1992). With `r = L g`, `L Lᵀ` the blocks of the diagonal and g
    /// normally distributed, `u·v` is so too, with a variance of at least `(1 − q²)/Λ` of the smoother alone, Λ the largest eigenvalue
    /// of `D⁻¹ A`. Hence the chance of an eigenvalue that stays unseen is at most `√(2/π) ε √(rᵀ M⁻¹ r Λ/(1 − q²))`.
    ///
    /// # Errors
    /// The watch broke off, or numbers are not finite.
    pub fn definiteness(&self, doubt: f64, steps: usize, watch: &mut Watch) -> Result<Definiteness, Fault> {
        let rows = self.rows();
        let mut room = self.workspace();
        // The seed is fixed: the same matrix has the same answer in each run.
        let mut random = Random::new(0x5eed);
        let mut r: Vec<[f64; D]> = (0..rows)
            .map(|row| {
                let normal: [f64; D] = std::array::from_fn(|_| random.normal());
                // The start has the covariance D, not the identity, because then its
                // variance along every motion has the bound of the smoother alone.
                root_product(&self.first.matrix.diagonal(row), &self.is_held[row].map(|held| !held), &normal)
            })
            .collect();
        let mut z = vec![[0.0; D]; rows];
        self.apply(&r, &mut z, &mut room);
        let (mut p, mut ap) = (z.clone(), z.clone());
        let mut along = dot(&r, &z);
        // Nothing is free, or there are no rows: there is no motion that could be unseen.
        if along == 0.0 {
            return Ok(Definiteness::Positive { doubt: 0.0, iterations: 0 });
        }
        let first = along;
        let smoother = &self.first.smoother;
        // The factor `√(2/π)` bounds the chance that a normal variable is small: the density of `|u·v|` is nowhere
        // above that of zero, which is `√(2/π)` over the deviation.
        let weight = (2.0 / PI * first * smoother.upper / (1.0 - smoother.damping())).sqrt();
        let mut t = Lanczos::default();
        let (mut least, mut chance) = (1.0, 1.0);
        for k in 1..=steps {
            self.matrix().apply(&p, &mut ap);
            let energy = dot(&p, &ap);
            // Whatever the preconditioner is worth, this direction is a proof by itself. The negation takes what is not a number along.
            if !(energy > 0.0) {
                return match self.not_positive(&p, energy) {
                    Fault::NotPositive(motion) => Ok(Definiteness::NotPositive { motion, iterations: k }),
                    other => Err(other),
                };
            }
            let step = along / energy;
            combine(&mut r, 1.0, &ap, -step);
            // The matrix has the rows of what is held, whose forces must not enter the search again.
            self.mask(&mut r);
            self.apply(&r, &mut z, &mut room);
            let next = dot(&r, &z);
            t.step(step, next / along);
            if watch(Event::Iteration { number: k, residual: (next / first).max(0.0).sqrt() }).is_break() {
                return Err(Fault::Interrupted);
            }
            // The eigenvalues of all k steps are bisected anew at each look. Steps beyond the one that suffices cost a
            // product and a V-cycle each, so that a look every four steps wastes at most three.
            if k % LOOK == 0 || k == steps || !(next > 0.0) {
                let [low, high] = t.matrix.extremes().unwrap_or([1.0; 2]);
                let bound = (MARGIN * high).max(1.0);
                least = low;
                // The whole space is seen where nothing is left.
                chance = if next > 0.0 { weight * unseen(low, bound, k) } else { 0.0 };
                if low <= NOTHING {
                    // A zero with rounding: the direction of least energy is the last one, or near it.
                    return match self.not_positive(&p, energy) {
                        Fault::NotPositive(motion) => Ok(Definiteness::NotPositive { motion, iterations: k }),
                        other => Err(other),
                    };
                }
                if chance <= doubt {
                    return Ok(Definiteness::Positive { doubt: chance, iterations: k });
                }
            }
            combine(&mut p, next / along, &z, 1.0);
            along = next;
        }
        // After few steps the bound is above one, which no chance is.
        Ok(Definiteness::Undecided { least, doubt: chance.min(1.0), iterations: steps })
    }
}

/// ε of the bound.
fn unseen(theta: f64, c: f64, k: usize) -> f64 {
    let argument = ((c + theta) / (c - theta).max(f64::MIN_POSITIVE)).acosh();
    // cosh overflows late; its logarithm does not.
    // Half of the exponential is below cosh, so that the bound is rather too large than too small.
    let log = argument * (k - 1) as f64 - 2.0_f64.ln();
    ((c - theta).max(0.0) / theta).sqrt() * (-log.max(0.0)).exp()
}

/// `L g`, with `L Lᵀ` the block on what is free.
fn root_product<const D: usize>(a: &Block<D, D>, free: &[bool; D], g: &[f64; D]) -> [f64; D] {
    let mut l = [[0.0; D]; D];
    for i in (0..D).filter(|i| free[*i]) {
        for j in (0..=i).filter(|j| free[*j]) {
            let rest = a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            // No pivot is zero here: levels are not built of blocks with a pivot that is rounding.
            l[i][j] = if i == j { rest.max(0.0).sqrt() } else { rest / l[j][j] };
        }
    }
    std::array::from_fn(|i| (0..D).map(|j| l[i][j] * g[j]).sum())
}
