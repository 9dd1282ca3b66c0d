//! Exact rational functions of several variables, in lowest terms: numbers in which a kernel's result is a formula.

mod divisor;
mod field;
mod lattice;
mod packed;
mod polynomial;
mod print;
mod scalar;

pub use polynomial::Polynomial;

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Zero};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number times a numerator over a denominator without a common divisor. Both have integer coefficients without a
/// common divisor, of which the first of [`Polynomial::sorted`] is positive; so equal functions are equal fractions.
///
/// Fractions that meet in an operation have the same number of variables.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fraction {
    content: BigRational,
    numerator: Polynomial,
    denominator: Polynomial,
}

impl Fraction {
    /// # Panics
    /// If the denominator is zero.
    pub fn new(numerator: Polynomial, denominator: Polynomial) -> Fraction {
        assert!(!denominator.is_zero(), "a fraction is divided by zero");
        if numerator.is_zero() {
            return Fraction::number(BigRational::zero(), denominator.variables());
        }
        let [_, numerator, denominator] = numerator.with_cofactors(&denominator);
        Fraction {
            content: numerator.content() / denominator.content(),
            numerator: numerator.primitive(),
            denominator: denominator.primitive(),
        }
    }

    /// `c`, as a function of `variables` variables.
    pub fn number(c: BigRational, variables: usize) -> Fraction {
        let one = Polynomial::constant(BigRational::one(), variables);
        let numerator = if c.is_zero() { Polynomial::default() } else { one.clone() };
        Fraction { content: c, numerator, denominator: one }
    }

    /// The variable of that index among `variables`.
    pub fn variable(index: usize, variables: usize) -> Fraction {
        Fraction {
            content: BigRational::one(),
            numerator: Polynomial::variable(index, variables),
            denominator: Polynomial::constant(BigRational::one(), variables),
        }
    }

    /// The number in front, with the sign.
    pub fn content(&self) -> &BigRational {
        &self.content
    }

    /// What the content multiplies; zero if the fraction is.
    pub fn numerator(&self) -> &Polynomial {
        &self.numerator
    }

    pub fn denominator(&self) -> &Polynomial {
        &self.denominator
    }

    pub fn variables(&self) -> usize {
        self.denominator.variables()
    }

    pub fn is_zero(&self) -> bool {
        self.content.is_zero()
    }

    /// The value where the variables have the values `at`, or `None` at a pole.
    pub fn evaluate(&self, at: &[BigRational]) -> Option<BigRational> {
        let below = self.denominator.evaluate(at);
        (!below.is_zero()).then(|| &self.content * self.numerator.evaluate(at) / below)
    }

    /// `1/self`.
    ///
    /// # Panics
    /// If `self` is zero.
    pub fn inverse(&self) -> Fraction {
        assert!(!self.is_zero(), "a fraction is divided by zero");
        Fraction {
            content: self.content.recip(),
            numerator: self.denominator.clone(),
            denominator: self.numerator.clone(),
        }
    }

    /// Henrici's sum of `self` and `c` times the other's polynomials: only what the denominators share can cancel.
    fn plus(&self, c: &BigRational, other: &Fraction) -> Fraction {
        let [shared, below, other_below] = self.denominator.with_cofactors(&other.denominator);
        let unit = BigRational::new_raw(BigInt::one(), self.content.denom().lcm(c.denom()));
        let term = (&self.numerator * &other_below).scaled(&(&self.content / &unit));
        let numerator = &term + &(&other.numerator * &below).scaled(&(c / &unit));
        if numerator.is_zero() {
            return Fraction::number(BigRational::zero(), self.variables());
        }
        let [_, numerator, shared] = numerator.with_cofactors(&shared);
        Fraction {
            content: numerator.content() * unit,
            numerator: numerator.primitive(),
            denominator: &(&below * &other_below) * &shared,
        }
    }

    /// The product: only a numerator and the other's denominator can cancel.
    fn times(&self, other: &Fraction) -> Fraction {
        if self.is_zero() || other.is_zero() {
            return Fraction::number(BigRational::zero(), self.variables());
        }
        let [_, above, other_below] = self.numerator.with_cofactors(&other.denominator);
        let [_, other_above, below] = other.numerator.with_cofactors(&self.denominator);
        Fraction {
            content: &self.content * &other.content,
            numerator: &above * &other_above,
            denominator: &below * &other_below,
        }
    }
}

impl Neg for Fraction {
    type Output = Fraction;

    fn neg(self) -> Fraction {
        Fraction { content: -self.content, ..self }
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $a:ident, $b:ident => $result:expr) => {
        impl $trait<&Fraction> for &Fraction {
            type Output = Fraction;

            fn $method(self, other: &Fraction) -> Fraction {
                let ($a, $b) = (self, other);
                $result
            }
        }

        impl $trait<&Fraction> for Fraction {
            type Output = Fraction;

            fn $method(self, other: &Fraction) -> Fraction {
                $trait::$method(&self, other)
            }
        }

        impl $trait for Fraction {
            type Output = Fraction;

            fn $method(self, other: Fraction) -> Fraction {
                $trait::$method(&self, &other)
            }
        }
    };
}

operator!(Add, add, a, b => a.plus(&b.content, b));
operator!(Sub, sub, a, b => a.plus(&-&b.content, b));
operator!(Mul, mul, a, b => a.times(b));
operator!(Div, div, a, b => a.times(&b.inverse()));
