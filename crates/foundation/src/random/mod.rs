//! Reproducible random numbers and points that fill a cube evenly: a seed gives the same ones on every machine.

mod latin;
mod sobol;

pub use latin::Latin;
pub use sobol::{DIMENSIONS, Sobol};

/// A linear congruential generator with Knuth's constants.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// The generator with this seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// The next number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.symmetric() + 1.0) / 2.0
    }

    /// The next number in [−1, 1).
    pub fn symmetric(&mut self) -> f64 {
        // The multiplier and the increment are those of Knuth's MMIX: the sequence has the full period of 2⁶⁴.
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        // 53 bits are a double without rounding, and the lowest bits of such a generator repeat soonest.
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A number in [0, 1) that a seed and two places decide, without those before it (SplitMix64, Steele, Lea and Flood 2014).
pub fn unit_at(seed: u64, index: u64, coordinate: u64) -> f64 {
    let mixed = mix(mix(mix(seed).wrapping_add(index)).wrapping_add(coordinate));
    (mixed >> 11) as f64 / (1u64 << 53) as f64
}

/// Spreads the bits of a number over all of its bits, so that neighbouring numbers have no pattern.
pub fn mix(number: u64) -> u64 {
    let mut z = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
