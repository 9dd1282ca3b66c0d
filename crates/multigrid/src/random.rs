//! Numbers that look random and are the same on every machine.

/// Steele, Lea, Flood, OOPSLA 2014 (SplitMix64).
pub(crate) struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// Above 0 and at most 1.
    fn uniform(&mut self) -> f64 {
        // The increment is 2⁶⁴ over the golden ratio, and odd, so that all numbers are passed before one comes again.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        // The upper 53 bits are a double without rounding; half a unit keeps zero away, whose logarithm is not finite.
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + 0.5 / (1u64 << 53) as f64
    }

    /// Normally distributed with variance 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = ((-2.0 * self.uniform().ln()).sqrt(), std::f64::consts::TAU * self.uniform());
        radius * angle.cos()
    }

    pub fn vector<const N: usize>(&mut self, rows: usize) -> Vec<[f64; N]> {
        (0..rows).map(|_| std::array::from_fn(|_| self.normal())).collect()
    }
}
