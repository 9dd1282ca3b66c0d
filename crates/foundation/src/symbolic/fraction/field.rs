//! Integers modulo a prime just below 2⁶¹, and polynomials over them. A polynomial is its list of coefficients from the
//! constant on; the last coefficient is not zero.

use num_bigint::BigInt;
use num_traits::ToPrimitive;

/// The integers modulo `2⁶¹ − below`.
pub struct Field {
    below: u64,
    state: u64,
}

/// The bits of the primes. A sum of two numbers fits into `u64`, and a product into `u128`.
const BITS: u32 = 61;

impl Field {
    /// The fields whose primes are below 2⁶¹, from the largest prime down.
    pub fn all() -> impl Iterator<Item = Field> {
        // An odd number is taken from 2⁶¹, because an even one leaves an even number.
        (1..1 << 20).step_by(2).map(|below| Field { below, state: below }).filter(Field::is_field)
    }

    pub fn prime(&self) -> u64 {
        (1 << BITS) - self.below
    }

    /// The Miller–Rabin test, which with these bases is a proof for numbers of 64 bits.
    fn is_field(&self) -> bool {
        let even = self.prime() - 1;
        let twos = even.trailing_zeros();
        // 2⁶¹ − 1 is a prime of Mersenne: most divisors need no other, and no test.
        self.below == 1
            || [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37].into_iter().all(|base| {
                let first = self.power(base, even >> twos);
                let mut squares = std::iter::successors(Some(first), |x| Some(self.product(*x, *x)));
                first == 1 || squares.by_ref().take(twos as usize).any(|x| x == even)
            })
    }

    fn reduce(&self, x: u128) -> u64 {
        let fold = |x: u128| (x & ((1 << BITS) - 1)) + (x >> BITS) * u128::from(self.below);
        // A product has at most 123 bits, the first fold leaves 82 of them and
        // the second less than the prime and 2⁴¹: one subtraction completes it.
        let (x, prime) = (fold(fold(x)) as u64, self.prime());
        if x >= prime { x - prime } else { x }
    }

    pub fn product(&self, a: u64, b: u64) -> u64 {
        self.reduce(u128::from(a) * u128::from(b))
    }

    pub fn difference(&self, a: u64, b: u64) -> u64 {
        if a >= b { a - b } else { a + self.prime() - b }
    }

    /// `a b − c d`.
    fn cross(&self, a: u64, b: u64, c: u64, d: u64) -> u64 {
        self.reduce(u128::from(a) * u128::from(b) + u128::from(self.prime() - c) * u128::from(d))
    }

    fn power(&self, mut base: u64, mut exponent: u64) -> u64 {
        let mut power = 1;
        while exponent > 0 {
            if exponent & 1 == 1 {
                power = self.product(power, base);
            }
            base = self.product(base, base);
            exponent >>= 1;
        }
        power
    }

    pub fn inverse(&self, a: u64) -> u64 {
        self.power(a, self.prime() - 2)
    }

    pub fn residue(&self, c: &BigInt) -> u64 {
        let prime = self.prime() as i64;
        let remainder = (c % prime).to_i64().expect("a remainder is smaller than its prime");
        remainder.rem_euclid(prime) as u64
    }

    /// The integer of least magnitude with the residue `a`.
    pub fn least(&self, a: u64) -> i64 {
        // Coefficients of either sign are known once twice their size is below the modulus.
        if a > self.prime() / 2 { a as i64 - self.prime() as i64 } else { a as i64 }
    }

    /// The next number of a random sequence, which is the same in every run.
    pub fn random(&mut self) -> u64 {
        // Knuth's numbers of MMIX, whose sequence has the full period of 2⁶⁴.
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // The lowest bits of such a sequence repeat soonest.
        (self.state >> 4) % self.prime()
    }

    pub fn value(&self, p: &[u64], at: u64) -> u64 {
        p.iter().rev().fold(0, |value, c| self.reduce(u128::from(value) * u128::from(at) + u128::from(*c)))
    }

    /// The greatest common divisor of two polynomials; its last coefficient is one.
    pub fn divisor(&self, mut a: Vec<u64>, mut b: Vec<u64>) -> Vec<u64> {
        while !b.is_empty() {
            // A remainder that is a number has no divisor but numbers.
            if b.len() == 1 {
                return vec![1];
            }
            self.pseudo_remainder(&mut a, &b);
            std::mem::swap(&mut a, &mut b);
        }
        let inverse = self.inverse(a[a.len() - 1]);
        a.iter_mut().for_each(|c| *c = self.product(*c, inverse));
        a
    }

    /// A multiple of the remainder of `a` divided by `b`. It needs no inverse, which takes longer than the products.
    fn pseudo_remainder(&self, a: &mut Vec<u64>, b: &[u64]) {
        let lead = b[b.len() - 1];
        while a.len() >= b.len() {
            let (top, shift) = (a[a.len() - 1], a.len() - b.len());
            let (low, high) = a.split_at_mut(shift);
            low.iter_mut().for_each(|c| *c = self.product(*c, lead));
            high.iter_mut().zip(b).for_each(|(c, d)| *c = self.cross(*c, lead, top, *d));
            trim(a);
        }
    }

    /// The quotient `p/divisor`, for a divisor that divides `p` and whose last coefficient is one.
    pub fn quotient(&self, p: &[u64], divisor: &[u64]) -> Vec<u64> {
        let (mut rest, last) = (p.to_vec(), divisor.len() - 1);
        for shift in (0..rest.len() - last).rev() {
            let factor = rest[shift + last];
            for (i, d) in divisor[..last].iter().enumerate() {
                rest[shift + i] = self.cross(rest[shift + i], 1, factor, *d);
            }
        }
        rest.split_off(last)
    }

    pub fn polynomial_product(&self, p: &[u64], q: &[u64]) -> Vec<u64> {
        let mut product = vec![0; p.len() + q.len() - 1];
        for (i, c) in p.iter().enumerate() {
            for (j, d) in q.iter().enumerate() {
                product[i + j] = self.reduce(u128::from(*c) * u128::from(*d) + u128::from(product[i + j]));
            }
        }
        product
    }

    /// `p (x − root)`.
    pub fn times_root(&self, p: &[u64], root: u64) -> Vec<u64> {
        self.polynomial_product(p, &[self.difference(0, root), 1])
    }

    /// `p += c q`.
    pub fn add_multiple(&self, p: &mut Vec<u64>, c: u64, q: &[u64]) {
        p.resize(p.len().max(q.len()), 0);
        p.iter_mut().zip(q).for_each(|(a, b)| *a = self.reduce(u128::from(c) * u128::from(*b) + u128::from(*a)));
        trim(p);
    }
}

fn trim(p: &mut Vec<u64>) {
    while p.last() == Some(&0) {
        p.pop();
    }
}
