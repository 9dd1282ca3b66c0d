//! Expressions evaluated in double-double numbers, with elementary functions to 30 digits.
//!
//! Theory: page *Precision* of the book.

use super::Function;
use super::evaluate::{Differentiable, Value};
use crate::scalar::{DoubleDouble, Real, Scalar};
use num_rational::BigRational;
use num_traits::ToPrimitive;

/// `ln 2`, as the sum of three doubles.
const LN_2: [f64; 3] = [std::f64::consts::LN_2, 2.3190468138462996e-17, 5.707708438416212e-34];
/// `π/2`, as the sum of three doubles.
const HALF_PI: [f64; 3] = [std::f64::consts::FRAC_PI_2, 6.123233995736766e-17, -1.4973849048591698e-33];
/// How often the argument of an exponential is halved: from at most ln(2)/2 to below 10⁻³.
const HALVINGS: i32 = 9;
/// Terms of the exponential series; the remainder is below 10⁻³⁴.
const TERMS: usize = 12;
/// Terms of the series of sine and cosine for arguments up to π/4; the remainder is below 10⁻³⁴.
const WAVES: usize = 16;

impl Value for DoubleDouble {
    fn from_rational(c: &BigRational) -> Option<DoubleDouble> {
        let hi = c.to_f64()?;
        // A number beyond the range of `f64` is infinite and has no rest.
        let rest = BigRational::from_float(hi).and_then(|hi| (c - hi).to_f64());
        Some(DoubleDouble { hi, lo: rest.unwrap_or(0.0) })
    }

    fn to_power(self, exponent: &BigRational) -> Option<DoubleDouble> {
        Some(match exponent.to_i32().filter(|_| exponent.is_integer()) {
            Some(n) => self.whole_power(n),
            None => self.real_power(DoubleDouble::from_rational(exponent)?),
        })
    }

    fn apply(self, function: Function) -> Option<DoubleDouble> {
        let near = self.hi.apply(function)?;
        if !near.is_finite() || !self.hi.is_finite() {
            return Some(DoubleDouble::from(near));
        }
        let first = DoubleDouble::from(near);
        // Inverse functions are one step of Newton's method from the `f64` value.
        Some(match function {
            Function::Exp => exp(self),
            Function::Ln => first + &(self * &exp(first.negated()) - &self.one()),
            Function::Sin => sine_and_cosine(self)[0],
            Function::Cos => sine_and_cosine(self)[1],
            Function::Tan => {
                let [sine, cosine] = sine_and_cosine(self);
                sine / &cosine
            }
            Function::Asin => arc(self, (self.one() - &self.squared()).sqrt(), first),
            Function::Acos => arc((self.one() - &self.squared()).sqrt(), self, first),
            Function::Atan => arc(self, self.one(), first),
            Function::Abs if self.hi < 0.0 => self.negated(),
            Function::Abs => self,
            Function::Step => first,
        })
    }
}

impl Differentiable for DoubleDouble {
    fn number(c: DoubleDouble) -> DoubleDouble {
        c
    }

    fn whole_power(self, exponent: i32) -> DoubleDouble {
        let mut count = exponent.unsigned_abs();
        let (mut power, mut square) = (self.one(), self);
        while count > 0 {
            power = if count % 2 == 1 { power * &square } else { power };
            count /= 2;
            square = if count > 0 { square.squared() } else { square };
        }
        if exponent < 0 { self.one() / &power } else { power }
    }

    fn real_power(self, exponent: DoubleDouble) -> DoubleDouble {
        let doubled = 2.0 * exponent.hi;
        // Powers of halves are products and one root. They keep digits that
        // the product of exponent and logarithm would lose for large results.
        if exponent.lo == 0.0 && doubled.fract() == 0.0 && doubled.abs() <= f64::from(i32::MAX) {
            return self.sqrt().whole_power(doubled as i32);
        }
        let logarithm = self.apply(Function::Ln).unwrap_or(DoubleDouble::from(f64::NAN));
        (exponent * &logarithm).apply(Function::Exp).unwrap_or(DoubleDouble::from(f64::NAN))
    }
}

/// `x` minus `count` times a number that is given as three doubles.
fn less(x: DoubleDouble, count: f64, parts: &[f64; 3]) -> DoubleDouble {
    // Part after part, so that what a multiple of the first two cancels does not take the last digits along (Cody and Waite 1980).
    parts.iter().fold(x, |x, part| x - &(DoubleDouble::from(*part) * &DoubleDouble::from(count)))
}

/// `e^x = 2^n (1 + (e^r − 1))`, `r = x − n ln 2`.
fn exp(x: DoubleDouble) -> DoubleDouble {
    let count = (x.hi / LN_2[0]).round();
    let r = less(x, count, &LN_2).scaled(&2f64.powi(-HALVINGS));
    let mut sum = r.zero();
    for term in (1..=TERMS).rev() {
        // Horner's rule on r (1 + r/2 (1 + r/3 (…)))
        sum = (sum + &r.one()) * &r / &DoubleDouble::from(term as f64);
    }
    for _ in 0..HALVINGS {
        // e^2r − 1 = (e^r − 1) (e^r − 1 + 2)
        sum = sum * &(sum + &DoubleDouble::from(2.0));
    }
    // In two factors, because 2^n alone may overflow.
    let half = (count / 2.0).floor() as i32;
    (sum + &r.one()).scaled(&2f64.powi(half)).scaled(&2f64.powi(count as i32 - half))
}

fn sine_and_cosine(x: DoubleDouble) -> [DoubleDouble; 2] {
    let count = (x.hi / HALF_PI[0]).round();
    let r = less(x, count, &HALF_PI);
    let square = r.squared().negated();
    let series = |first: usize| {
        let one = r.one();
        (0..WAVES).rev().fold(r.zero(), |sum, i| {
            let next = (2 * i + first + 1) * (2 * i + first + 2);
            one + &(sum * &square / &DoubleDouble::from(next as f64))
        })
    };
    let (sine, cosine) = (series(1) * &r, series(0));
    // Each quarter of a turn exchanges sine and cosine, and one of them changes its sign.
    match count.rem_euclid(4.0) {
        1.0 => [cosine, sine.negated()],
        2.0 => [sine.negated(), cosine.negated()],
        3.0 => [cosine.negated(), sine],
        _ => [sine, cosine],
    }
}

/// The angle whose cosine and sine are given, near the `f64` value `first`.
fn arc(sine: DoubleDouble, cosine: DoubleDouble, first: DoubleDouble) -> DoubleDouble {
    let [s, c] = sine_and_cosine(first);
    let across = sine * &c - &(cosine * &s);
    first + &(across / &(cosine * &c + &(sine * &s)))
}
