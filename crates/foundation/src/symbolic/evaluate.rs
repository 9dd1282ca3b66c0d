//! Values of expressions in any kind of number.

use super::{Expr, Function};
use crate::scalar::{DoubleDouble, Real, Scalar};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};

/// The largest number of binary digits of an exact result. Beyond it the exact value is given up, so that no text can
/// cause hours of work.
const MOST_EXACT_BITS: u64 = 8000;
/// The largest exponent of an exact power, for the same reason.
const LARGEST_EXACT_EXPONENT: i32 = 1000;

/// A number in which an expression can be evaluated. An operation returns `None` if its result is not such a number.
pub trait Value: Scalar {
    /// The number `c`.
    fn from_rational(c: &BigRational) -> Option<Self>;
    /// `self` to the power of `exponent`.
    fn to_power(self, exponent: &BigRational) -> Option<Self>;
    /// The value of `function` at `self`.
    fn apply(self, function: Function) -> Option<Self>;

    /// Whether the number is small enough for the evaluation to continue.
    fn is_moderate(&self) -> bool {
        true
    }
}

/// The numbers in which a program computes values and derivatives: `f64` and [`DoubleDouble`].
pub trait Differentiable: Value + Real + From<f64> {
    /// The nearest number to `c`.
    fn number(c: DoubleDouble) -> Self;

    /// `self` to the power of a whole number.
    fn whole_power(self, exponent: i32) -> Self;

    /// `self` to the power of any number.
    fn real_power(self, exponent: DoubleDouble) -> Self;
}

impl Value for f64 {
    fn from_rational(c: &BigRational) -> Option<f64> {
        // One division of whole numbers that an f64 holds is rounded correctly. The general conversion gives the same number, and takes five
        // times as long: it computes with 128 bits.
        let whole = |n: &BigInt| n.to_i64().filter(|n| n.unsigned_abs() <= 1 << f64::MANTISSA_DIGITS);
        match (whole(c.numer()), whole(c.denom())) {
            (Some(n), Some(d)) => Some(n as f64 / d as f64),
            _ => c.to_f64(),
        }
    }
    fn to_power(self, exponent: &BigRational) -> Option<f64> {
        if let Some(n) = exponent.to_i32().filter(|_| exponent.is_integer()) {
            return Some(self.powi(n));
        }
        let p = exponent.to_f64()?;
        // A root is rounded correctly, a power is not.
        Some(if p == 0.5 { self.sqrt() } else { self.powf(p) })
    }
    fn apply(self, function: Function) -> Option<f64> {
        Some(match function {
            Function::Exp => self.exp(),
            Function::Ln => self.ln(),
            Function::Sin => self.sin(),
            Function::Cos => self.cos(),
            Function::Tan => self.tan(),
            Function::Asin => self.asin(),
            Function::Acos => self.acos(),
            Function::Atan => self.atan(),
            Function::Abs => self.abs(),
            Function::Step => f64::from(u8::from(self >= 0.0)),
        })
    }
}

impl Differentiable for f64 {
    fn number(c: DoubleDouble) -> f64 {
        c.hi
    }

    fn whole_power(self, exponent: i32) -> f64 {
        self.powi(exponent)
    }

    fn real_power(self, exponent: DoubleDouble) -> f64 {
        self.powf(exponent.hi)
    }
}

impl Value for BigRational {
    fn from_rational(c: &BigRational) -> Option<BigRational> {
        Some(c.clone())
    }
    fn to_power(self, exponent: &BigRational) -> Option<BigRational> {
        let n = exponent.to_i32().filter(|n| exponent.is_integer() && n.abs() <= LARGEST_EXACT_EXPONENT)?;
        // The digits of a power are at most this product, which is known before the power is.
        if bits(&self).saturating_mul(n.unsigned_abs().into()) > MOST_EXACT_BITS {
            return None;
        }
        // Rational arithmetic would end the program at a division by zero.
        if self.is_zero() && n < 0 {
            return None;
        }
        Some(num_traits::Pow::pow(self, n))
    }
    fn apply(self, function: Function) -> Option<BigRational> {
        match function {
            Function::Abs => Some(num_traits::Signed::abs(&self)),
            Function::Step if num_traits::Signed::is_negative(&self) => Some(Zero::zero()),
            Function::Step => Some(One::one()),
            Function::Exp if self.is_zero() => Some(One::one()),
            Function::Ln if self.is_one() => Some(Zero::zero()),
            _ => None,
        }
    }
    fn is_moderate(&self) -> bool {
        bits(self) <= MOST_EXACT_BITS
    }
}

fn bits(c: &BigRational) -> u64 {
    c.numer().bits().max(c.denom().bits())
}

impl Expr {
    /// The value at `at`, which has one entry per variable. `None` if the value is not a number of this kind: `sqrt(2)`
    /// is not a rational number.
    ///
    /// # Panics
    /// If `at` is shorter than the list of variables of the scope in which the expression was parsed.
    pub fn value<T: Value>(&self, at: &[T]) -> Option<T> {
        match self {
            Expr::Number(c) => T::from_rational(c),
            Expr::Variable(v) => Some(at[*v].clone()),
            Expr::Sum(terms) => {
                let (first, rest) = terms.split_first()?;
                rest.iter().try_fold(first.value(at)?, |s, t| Some(s + &t.value(at)?).filter(T::is_moderate))
            }
            Expr::Product(factors) => {
                let (first, rest) = factors.split_first()?;
                rest.iter().try_fold(first.value(at)?, |s, f| Some(s * &f.value(at)?).filter(T::is_moderate))
            }
            Expr::Power(base, exponent) => base.value(at)?.to_power(exponent),
            Expr::Call(function, argument) => argument.value(at)?.apply(*function),
        }
    }

    /// The value in floating point at `at`, which has one entry per variable; NaN or infinite if the expression has no
    /// finite value there.
    pub fn evaluate(&self, at: &[f64]) -> f64 {
        self.value(at).unwrap_or(f64::NAN)
    }
}
