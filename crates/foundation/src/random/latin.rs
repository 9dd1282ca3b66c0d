//! Latin hypercubes: of n points each lies in another nth of the range of every coordinate.
//!
//! McKay, Beckman and Conover, *A comparison of three methods for selecting values of input variables in the analysis of output from a
//! computer code*, Technometrics 21 (1979).

use super::{mix, unit_at};

/// Rounds of the permutation; each mixes both halves of a number.
// With random functions in each round, four are the least after which neither the permutation nor its inverse can be told from
// a random one (Luby and Rackoff, SIAM J. Comput. 17, 1988).
const ROUNDS: u64 = 4;

/// A Latin hypercube of some points, of which each is known without the others.
#[derive(Debug, Clone, Copy)]
pub struct Latin {
    count: u64,
    seed: u64,
    /// The bits of half a number of the smallest power of four that is not below the count.
    half: u32,
}

impl Latin {
    /// The hypercube of `count` points, at least one.
    pub fn new(count: usize, seed: u64) -> Latin {
        let count = count.max(1) as u64;
        // A hypercube of one point has no bits; half a bit could not be mixed.
        let bits = (u64::BITS - (count - 1).leading_zeros()).max(1);
        Latin { count, seed, half: bits.div_ceil(2) }
    }

    /// A coordinate of point `index`, in [0, 1); points after the last are those from the first.
    pub fn at(&self, index: usize, coordinate: usize) -> f64 {
        let index = index as u64 % self.count;
        let share = unit_at(self.seed, index, coordinate as u64);
        // The largest share may round up to the next slice.
        ((self.slice(index, coordinate as u64) as f64 + share) / self.count as f64).min(1.0 - f64::EPSILON)
    }

    /// The slice of a point along a coordinate: a permutation of `0..count`, by a Feistel network that is repeated until it ends within.
    fn slice(&self, index: u64, coordinate: u64) -> u64 {
        let mask = (1 << self.half) - 1;
        let mut place = index;
        // The power of four is at most four times the count: few rounds end outside.
        // A permutation comes back to a number within, so that the loop ends.
        loop {
            let (mut left, mut right) = (place >> self.half, place & mask);
            for round in 0..ROUNDS {
                let key = mix(self.seed ^ mix(coordinate * ROUNDS + round));
                (left, right) = (right, left ^ (mix(right ^ key) & mask));
            }
            place = (left << self.half) | right;
            if place < self.count {
                return place;
            }
        }
    }
}
