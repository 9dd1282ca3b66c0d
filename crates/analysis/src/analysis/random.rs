//! Reproducible random numbers: a seed gives the same shapes on every machine.

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
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
