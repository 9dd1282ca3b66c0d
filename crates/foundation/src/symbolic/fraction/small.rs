//! Rational numbers whose parts fit into machine words are added and multiplied there: coefficients of polynomials are rarely larger, and
//! numbers of any length take room on the heap for each step of a common divisor.

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive};

/// The parts of a number in lowest terms, if each fits into a word.
fn parts(c: &BigRational) -> Option<(i64, i64)> {
    Some((c.numer().to_i64()?, c.denom().to_i64()?))
}

/// The greatest common divisor of a number and a positive one, which is not less than it.
fn divisor(a: i64, b: i64) -> i64 {
    a.unsigned_abs().gcd(&b.unsigned_abs()) as i64
}

/// `a b` in lowest terms.
pub fn product(a: &BigRational, b: &BigRational) -> BigRational {
    let Some(((a, c), (b, d))) = parts(a).zip(parts(b)) else { return a * b };
    let (first, second) = (divisor(a, d), divisor(b, c));
    let (a, d) = (a / first, d / first);
    let (b, c) = (b / second, c / second);
    let part = |a: i64, b: i64| BigInt::from(i128::from(a) * i128::from(b));
    BigRational::new_raw(part(a, b), part(c, d))
}

/// `a + b` in lowest terms: only a common divisor of the denominators can cancel (Henrici).
pub fn sum(a: &BigRational, b: &BigRational) -> BigRational {
    let words = || {
        let ((a, c), (b, d)) = parts(a).zip(parts(b))?;
        let shared = divisor(c, d);
        let (c, d) = (c / shared, d / shared);
        let above = (i128::from(a) * i128::from(d)).checked_add(i128::from(b) * i128::from(c))?;
        // The remainder is below the divisor, which is a word.
        let cancels = divisor((above % i128::from(shared)) as i64, shared);
        let below = i128::from(c) * i128::from(d);
        let below = below.checked_mul(i128::from(shared / cancels))?;
        Some(BigRational::new_raw(BigInt::from(above / i128::from(cancels)), BigInt::from(below)))
    };
    words().unwrap_or_else(|| a + b)
}

/// The greatest common divisor.
pub fn common_divisor(a: &BigInt, b: &BigInt) -> BigInt {
    match (a.magnitude().to_u64(), b.magnitude().to_u64()) {
        (Some(a), Some(b)) => BigInt::from(a.gcd(&b)),
        _ => a.gcd(b),
    }
}

/// The least common multiple of positive numbers.
pub fn common_multiple(a: &BigInt, b: &BigInt) -> BigInt {
    if a == b || b.is_one() { a.clone() } else { a / common_divisor(a, b) * b }
}

/// `integer · c` in lowest terms.
pub fn multiple(integer: &BigInt, c: &BigRational) -> BigRational {
    if c.is_integer() {
        return BigRational::from_integer(integer * c.numer());
    }
    product(&BigRational::from_integer(integer.clone()), c)
}
