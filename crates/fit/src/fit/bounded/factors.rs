//! Equations solved by factors, those of each lane gathered from its free constants.

use super::{Equations, State};
use crate::fit::normal::Normal;
use crate::scalar::{Packed, vectorized};

/// The equations, with the working memory.
#[derive(Debug, Clone)]
pub struct Factors<T> {
    /// The lower triangle of M, scaled, `[unknowns × unknowns]`.
    gram: Vec<T>,
    scale: Vec<T>,
    /// The equations of the free constants. Lanes that have fewer of them have rows of the identity.
    part: Normal<T>,
    /// The free constants of one lane after the other.
    sets: Vec<usize>,
}

impl<T> Default for Factors<T> {
    fn default() -> Factors<T> {
        Factors { gram: Vec::new(), scale: Vec::new(), part: Normal::default(), sets: Vec::new() }
    }
}

impl<T: Packed> Factors<T> {
    pub fn set(&mut self, equations: &Normal<T>) {
        let Factors { gram, scale, .. } = self;
        let m = equations.size();
        gram.clone_from(&equations.gram);
        scale.clone_from(&equations.rhs);
        let one = gram[0].one();
        vectorized!(one, {
            for s in 0..m {
                let row = &mut gram[s * m..=s * m + s];
                // With a unit diagonal one tolerance serves the slopes of short and of long springs.
                scale[s] = one.clone() / &row[s].clone().sqrt();
                for (entry, other) in row.iter_mut().zip(&*scale) {
                    *entry = entry.clone() * &(scale[s].clone() * other);
                }
            }
        });
    }

    /// Solves the equations of the free constants of these lanes.
    #[inline(always)]
    fn solve_part(&mut self, state: &mut State<T>, lanes: &[usize]) -> bool {
        let Factors { gram, part, sets, .. } = self;
        let State { rhs, free, constants, .. } = state;
        let m = rhs.len();
        sets.clear();
        let mut ends = Vec::with_capacity(T::COUNT);
        for &lane in lanes {
            sets.extend((0..m).filter(|&s| free[s].as_slice()[lane] > 0.0));
            ends.push(sets.len());
        }
        let sets =
            || lanes.iter().zip(ends.iter().scan(0, |start, &end| Some(&sets[std::mem::replace(start, end)..end])));
        let n = sets().map(|(_, set)| set.len()).max().unwrap_or(0);
        part.gram.clear();
        part.gram.resize(n * n, rhs[0].zero());
        part.rhs.clear();
        part.rhs.resize(n, rhs[0].zero());
        // All lanes are factorised with the order of the largest set. An
        // identity below the equations of the others leaves them as they are.
        part.gram.iter_mut().step_by(n + 1).for_each(|entry| *entry = entry.one());
        for (&lane, set) in sets() {
            for (i, &s) in set.iter().enumerate() {
                let row = &gram[s * m..=s * m + s];
                for (entry, &t) in part.gram[i * n..=i * n + i].iter_mut().zip(set) {
                    entry.as_mut_slice()[lane] = row[t].as_slice()[lane];
                }
                part.rhs[i].as_mut_slice()[lane] = rhs[s].as_slice()[lane];
            }
        }
        if !part.solve_regular() {
            return false;
        }
        for (&lane, set) in sets() {
            constants.iter_mut().for_each(|k| k.as_mut_slice()[lane] = 0.0);
            for (k, &s) in part.rhs.iter().zip(set) {
                constants[s].as_mut_slice()[lane] = k.as_slice()[lane];
            }
        }
        true
    }
}

impl<T: Packed> Equations<T> for Factors<T> {
    const EXACT: bool = true;

    fn scale(&self) -> &[T] {
        &self.scale
    }

    #[inline(always)]
    fn solve(&mut self, state: &mut State<T>, limits: &T) -> bool {
        // Lanes with an infinite limit have ended or wait: their constants stay as they are.
        let lanes: Vec<usize> = (0..T::COUNT).filter(|&lane| limits.as_slice()[lane].is_finite()).collect();
        if !self.solve_part(state, &lanes) {
            return false;
        }
        let State { rhs, constants, rest, .. } = state;
        for (s, (row, k)) in self.gram.chunks_exact(rhs.len()).zip(&*constants).enumerate() {
            // M is symmetric, and each entry of its lower triangle serves two rows.
            let (before, current) = rest.split_at_mut(s);
            let mut sum = rhs[s].clone().minus_product(&row[s], k);
            for ((entry, other), rest) in row.iter().zip(&*constants).zip(before) {
                sum = sum.minus_product(entry, other);
                *rest = rest.clone().minus_product(entry, k);
            }
            current[0] = sum;
        }
        true
    }
}
