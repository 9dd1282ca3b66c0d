use super::{Expr, Function};
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};

/// A number an expression can be evaluated in. `None` where the value is not one of these numbers.
pub trait Value: Clone {
    fn from_rational(c: &BigRational) -> Option<Self>;
    fn plus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn to_power(self, exponent: &BigRational) -> Option<Self>;
    fn apply(self, function: Function) -> Option<Self>;
}

impl Value for f64 {
    fn from_rational(c: &BigRational) -> Option<f64> {
        c.to_f64()
    }
    fn plus(self, other: f64) -> f64 {
        self + other
    }
    fn times(self, other: f64) -> f64 {
        self * other
    }
    fn to_power(self, exponent: &BigRational) -> Option<f64> {
        let p = exponent.to_f64()?;
        Some(match exponent.to_i32() {
            Some(n) if exponent.is_integer() => self.powi(n),
            _ if p == 0.5 => self.sqrt(),
            _ => self.powf(p),
        })
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

impl Value for BigRational {
    fn from_rational(c: &BigRational) -> Option<BigRational> {
        Some(c.clone())
    }
    fn plus(self, other: BigRational) -> BigRational {
        self + other
    }
    fn times(self, other: BigRational) -> BigRational {
        self * other
    }
    fn to_power(self, exponent: &BigRational) -> Option<BigRational> {
        // A larger power would have too many digits to be worth being exact.
        let n = exponent.to_i32().filter(|n| exponent.is_integer() && n.abs() <= 1000)?;
        if self.is_zero() && n < 0 {
            return None;
        }
        Some(num_traits::Pow::pow(self, n))
    }
    fn apply(self, function: Function) -> Option<BigRational> {
        match function {
            Function::Abs => Some(num_traits::Signed::abs(&self)),
            Function::Step if num_traits::Signed::is_negative(&self) => Some(BigRational::zero()),
            Function::Step => Some(BigRational::one()),
            Function::Exp if self.is_zero() => Some(BigRational::one()),
            Function::Ln if self.is_one() => Some(BigRational::zero()),
            _ => None,
        }
    }
}

impl Expr {
    /// The value at `at` (one entry per variable), or `None` where it is not a number of this kind:
    /// `sqrt(2)` has no rational value.
    ///
    /// Indexing panics when `at` is shorter than the scope the expression was parsed in.
    pub fn value<T: Value>(&self, at: &[T]) -> Option<T> {
        match self {
            Expr::Number(c) => T::from_rational(c),
            Expr::Variable(v) => Some(at[*v].clone()),
            Expr::Sum(terms) => {
                let (first, rest) = terms.split_first()?;
                rest.iter().try_fold(first.value(at)?, |s, t| Some(s.plus(t.value(at)?)))
            }
            Expr::Product(factors) => {
                let (first, rest) = factors.split_first()?;
                rest.iter().try_fold(first.value(at)?, |s, f| Some(s.times(f.value(at)?)))
            }
            Expr::Power(base, exponent) => base.value(at)?.to_power(exponent),
            Expr::Call(function, argument) => argument.value(at)?.apply(*function),
        }
    }

    /// The value in floating point; NaN or infinite where the expression has no finite value.
    pub fn evaluate(&self, at: &[f64]) -> f64 {
        self.value(at).unwrap_or(f64::NAN)
    }
}
