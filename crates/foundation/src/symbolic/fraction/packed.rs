//! Polynomials with integer coefficients whose exponents are packed into the bits of one number, so that terms are
//! multiplied by adding these numbers.

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, Zero};
use std::collections::BTreeMap;

/// Nonzero terms in ascending order of their packed exponents.
pub(super) type Packed = Vec<(u128, BigInt)>;

/// The number of bits of each exponent, with the last variable in the lowest bits. Packed terms are ordered like their
/// lists of exponents.
#[derive(Debug, Clone)]
pub(super) struct Layout(Vec<u32>);

impl Layout {
    /// A layout for exponents up to `largest`.
    ///
    /// # Panics
    /// If they need more than 128 bits together. Five variables may have degrees up to 2²⁵.
    pub fn new(largest: impl Iterator<Item = u32>) -> Layout {
        let widths: Vec<u32> = largest.map(|degree| u32::BITS - degree.leading_zeros()).collect();
        assert!(widths.iter().sum::<u32>() <= u128::BITS, "the degrees of a polynomial are too large");
        Layout(widths)
    }

    pub fn widths(&self) -> &[u32] {
        &self.0
    }

    pub fn pack(&self, exponents: impl Iterator<Item = u32>) -> u128 {
        self.0.iter().zip(exponents).fold(0, |key, (width, e)| key << width | u128::from(e))
    }

    /// The exponents, the last variable's first.
    pub fn unpack(&self, mut key: u128) -> impl Iterator<Item = u32> {
        self.0.iter().rev().map(move |width| {
            let exponent = key & ((1 << width) - 1);
            key >>= width;
            // The mask has left the bits of one exponent, which was packed as a number of 32 bits.
            exponent as u32
        })
    }

    /// The largest exponents, the last variable's first.
    fn degrees(&self, p: &Packed) -> Vec<u32> {
        let mut degrees = vec![0; self.0.len()];
        for (key, _) in p {
            for (degree, e) in degrees.iter_mut().zip(self.unpack(*key)) {
                *degree = e.max(*degree);
            }
        }
        degrees
    }

    /// `a/b`, if that is a polynomial with integer coefficients.
    pub fn quotient(&self, a: &Packed, b: &Packed) -> Option<Packed> {
        let ((first, start), (last, lead)) = (b.first()?, b.last()?);
        // The lowest terms decide many divisions that fail, before a tree of terms is built.
        if a.first().is_some_and(|(key, c)| key < first || !c.is_multiple_of(start)) {
            return None;
        }
        // Exponents that do not exceed their bits do not carry into the bits of others, so that a quotient in the one
        // packed variable is a quotient in all variables.
        let room = self.degrees(a).into_iter().zip(self.degrees(b)).map(|(a, b)| a.checked_sub(b));
        let room: Vec<u32> = room.collect::<Option<_>>()?;
        let mut rest: BTreeMap<u128, BigInt> = a.iter().cloned().collect();
        // Terms are taken from the highest down, as the leading term of the divisor asks.
        let mut quotient = Vec::new();
        while let Some((key, c)) = rest.pop_last() {
            if c.is_zero() {
                continue;
            }
            let shift = key.checked_sub(*last)?;
            let (factor, remainder) = c.div_rem(lead);
            // A remainder, or a power that the quotient cannot have, shows that the division is not exact.
            if !remainder.is_zero() || self.unpack(shift).zip(&room).any(|(e, most)| e > *most) {
                return None;
            }
            for (key, d) in &b[..b.len() - 1] {
                *rest.entry(shift + key).or_default() -= &factor * d;
            }
            quotient.push((shift, factor));
        }
        quotient.reverse();
        Some(quotient)
    }
}

/// `a b`, for a layout whose exponents have enough bits for it.
pub(super) fn product(a: &Packed, b: &Packed) -> Packed {
    let mut product = BTreeMap::<u128, BigInt>::new();
    for (e, c) in a {
        for (f, d) in b {
            *product.entry(e + f).or_default() += c * d;
        }
    }
    product.into_iter().filter(|(_, c)| !c.is_zero()).collect()
}

/// Divides by the greatest common divisor of the coefficients.
pub(super) fn make_primitive(p: &mut Packed) {
    let mut content = BigInt::zero();
    for (_, c) in p.iter() {
        content = content.gcd(c);
        if content.is_one() {
            return;
        }
    }
    p.iter_mut().for_each(|(_, c)| *c /= &content);
}
