//! Sobol's sequence, in the order of Gray codes.
//!
//! The direction numbers are those of S. Joe and F. Y. Kuo, *Constructing Sobol sequences with better two-dimensional projections*,
//! SIAM J. Sci. Comput. 30 (2008), which SciPy and many other programs have.

use super::Random;

/// Bits of a coordinate, and the binary logarithm of the length of the sequence.
const BITS: usize = 32;
/// The largest number of dimensions.
pub const DIMENSIONS: usize = ROWS.len() + 1;

/// From the second dimension on, a primitive polynomial over GF(2), with its highest and lowest term, and the first direction numbers.
const ROWS: [(u32, &[u32]); 31] = [
    (0b11, &[1]),
    (0b111, &[1, 3]),
    (0b1011, &[1, 3, 1]),
    (0b1101, &[1, 1, 1]),
    (0b10011, &[1, 1, 3, 3]),
    (0b11001, &[1, 3, 5, 13]),
    (0b100101, &[1, 1, 5, 5, 17]),
    (0b101001, &[1, 1, 5, 5, 5]),
    (0b101111, &[1, 1, 7, 11, 19]),
    (0b110111, &[1, 1, 5, 1, 1]),
    (0b111011, &[1, 1, 1, 3, 11]),
    (0b111101, &[1, 3, 5, 5, 31]),
    (0b1000011, &[1, 3, 3, 9, 7, 49]),
    (0b1011011, &[1, 1, 1, 15, 21, 21]),
    (0b1100001, &[1, 3, 1, 13, 27, 49]),
    (0b1100111, &[1, 1, 1, 15, 7, 5]),
    (0b1101101, &[1, 3, 1, 15, 13, 25]),
    (0b1110011, &[1, 1, 5, 5, 19, 61]),
    (0b10000011, &[1, 3, 7, 11, 23, 15, 103]),
    (0b10001001, &[1, 3, 7, 13, 13, 15, 69]),
    (0b10001111, &[1, 1, 3, 13, 7, 35, 63]),
    (0b10010001, &[1, 3, 5, 9, 1, 25, 53]),
    (0b10011101, &[1, 3, 1, 13, 9, 35, 107]),
    (0b10100111, &[1, 3, 1, 5, 27, 61, 31]),
    (0b10101011, &[1, 1, 5, 11, 19, 41, 61]),
    (0b10111001, &[1, 3, 5, 3, 3, 13, 69]),
    (0b10111111, &[1, 1, 7, 13, 1, 19, 1]),
    (0b11000001, &[1, 3, 7, 5, 13, 19, 59]),
    (0b11001011, &[1, 1, 3, 9, 25, 29, 41]),
    (0b11010011, &[1, 3, 5, 13, 23, 1, 55]),
    (0b11010101, &[1, 3, 7, 3, 13, 59, 17]),
];

/// The points of a sequence, each in [0, 1)ᵈ.
#[derive(Debug, Clone)]
pub struct Sobol {
    directions: Vec<[u32; BITS]>,
    shift: Vec<u32>,
    count: u32,
}

impl Sobol {
    /// The sequence from its first point, which is the origin. With a seed all points are moved by one digital shift (exclusive or),
    /// which keeps how evenly they lie; at most [`DIMENSIONS`].
    pub fn new(dimensions: usize, seed: Option<u64>) -> Sobol {
        let mut random = seed.map(Random::new);
        let mut shift = |_| random.as_mut().map_or(0, |random| (random.unit() * 2f64.powi(BITS as i32)) as u32);
        let directions = (0..dimensions).map(|d| d.checked_sub(1).map_or_else(first, |row| directions(ROWS[row])));
        Sobol { directions: directions.collect(), shift: (0..dimensions).map(&mut shift).collect(), count: 0 }
    }

    /// The point that is next.
    pub fn point(&mut self) -> Vec<f64> {
        let point = (0..self.shift.len()).map(|coordinate| self.at(self.count, coordinate)).collect();
        self.count = self.count.wrapping_add(1);
        point
    }

    /// A coordinate of the point with this number, from 0.
    pub fn at(&self, index: u32, coordinate: usize) -> f64 {
        // The bits of the Gray code of the number choose the directions.
        let mut left = index ^ (index >> 1);
        let mut x = self.shift[coordinate];
        while left != 0 {
            x ^= self.directions[coordinate][left.trailing_zeros() as usize];
            left &= left - 1;
        }
        // A number of 32 bits over a power of two is exact in a double, and below one.
        f64::from(x) / 2f64.powi(BITS as i32)
    }
}

/// Returns the direction numbers of the first dimension: van der Corput's sequence.
fn first() -> [u32; BITS] {
    std::array::from_fn(|i| 1 << (BITS - 1 - i))
}

/// `v_i = a_1 v_{i−1} ⊕ … ⊕ a_{s−1} v_{i−s+1} ⊕ v_{i−s} ⊕ (v_{i−s} ≫ s)`, where a are the coefficients of the polynomial of degree s.
fn directions((polynomial, initial): (u32, &[u32])) -> [u32; BITS] {
    let s = initial.len();
    let mut v = [0; BITS];
    for i in 0..BITS {
        v[i] = match initial.get(i) {
            Some(m) => m << (BITS - 1 - i),
            None => {
                // The recurrence of Bratley and Fox (ACM Transactions on Mathematical Software 14, 1988): the terms of
                // the polynomial between its first and last choose earlier directions.
                let chosen = (1..s).filter(|k| polynomial >> (s - k) & 1 == 1);
                chosen.fold(v[i - s] ^ (v[i - s] >> s), |sum, k| sum ^ v[i - k])
            }
        };
    }
    v
}
