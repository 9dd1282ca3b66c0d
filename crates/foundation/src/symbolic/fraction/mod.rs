//! Exact rational functions of several variables, in lowest terms. A kernel that computes with them returns a formula.
//!
//! Theory: page *Stiffness and the reduced space* of the book (closed forms).

mod divisor;
mod field;
mod lattice;
mod packed;
mod polynomial;
mod print;
mod scalar;
mod small;
mod value;

pub use polynomial::Polynomial;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// A number times a numerator divided by a denominator; numerator and denominator have no common divisor. Both have
/// integer coefficients without a common divisor, of which the first one in the order of [`Polynomial::sorted`] is
/// positive. Equal functions are therefore equal fractions.
///
/// All fractions of one operation must have the same number of variables.
///
/// Copies share their terms, because kernels copy often.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fraction(Arc<Terms>);

#[derive(Debug, PartialEq, Eq)]
struct Terms {
    content: BigRational,
    numerator: Polynomial,
    denominator: Polynomial,
}

impl Fraction {
    /// The quotient of two polynomials.
    ///
    /// # Panics
    /// If the denominator is zero.
    pub fn new(numerator: Polynomial, denominator: Polynomial) -> Fraction {
        assert!(!denominator.is_zero(), "a fraction is divided by zero");
        if numerator.is_zero() {
            return Fraction::number(BigRational::zero(), denominator.variables());
        }
        let [_, numerator, denominator] = numerator.with_cofactors(&denominator);
        let content = numerator.content() / denominator.content();
        Fraction::of(content, numerator.primitive(), denominator.primitive())
    }

    /// The fraction of polynomials that are as those of a fraction must be.
    fn of(content: BigRational, numerator: Polynomial, denominator: Polynomial) -> Fraction {
        Fraction(Arc::new(Terms { content, numerator, denominator }))
    }

    /// The number `c`, as a function of `variables` variables.
    pub fn number(c: BigRational, variables: usize) -> Fraction {
        let one = Polynomial::constant(BigRational::one(), variables);
        let numerator = if c.is_zero() { Polynomial::default() } else { one.clone() };
        Fraction::of(c, numerator, one)
    }

    /// The variable with this index, of `variables` variables.
    pub fn variable(index: usize, variables: usize) -> Fraction {
        let one = Polynomial::constant(BigRational::one(), variables);
        Fraction::of(BigRational::one(), Polynomial::variable(index, variables), one)
    }

    /// The number in front, with its sign.
    pub fn content(&self) -> &BigRational {
        &self.0.content
    }

    /// The numerator, without the content; zero if the fraction is zero.
    pub fn numerator(&self) -> &Polynomial {
        &self.0.numerator
    }

    /// The denominator.
    pub fn denominator(&self) -> &Polynomial {
        &self.0.denominator
    }

    /// The number of variables.
    pub fn variables(&self) -> usize {
        self.0.denominator.variables()
    }

    /// Whether the function is zero everywhere.
    pub fn is_zero(&self) -> bool {
        self.0.content.is_zero()
    }

    /// The value at the point `at`, or `None` at a pole.
    pub fn evaluate(&self, at: &[BigRational]) -> Option<BigRational> {
        let below = self.0.denominator.evaluate(at);
        (!below.is_zero()).then(|| &self.0.content * self.0.numerator.evaluate(at) / below)
    }

    /// `1/self`.
    ///
    /// # Panics
    /// If `self` is zero.
    pub fn inverse(&self) -> Fraction {
        assert!(!self.is_zero(), "a fraction is divided by zero");
        Fraction::of(self.0.content.recip(), self.0.denominator.clone(), self.0.numerator.clone())
    }

    /// Puts another number, which is not zero, in front of the polynomials.
    fn of_content(&self, content: BigRational) -> Fraction {
        Fraction::of(content, self.0.numerator.clone(), self.0.denominator.clone())
    }

    /// The sum of `self` and `c` times the polynomials of the other (Henrici): only common factors of the denominators
    /// can cancel.
    fn plus(&self, c: &BigRational, other: &Fraction) -> Fraction {
        let [shared, below, other_below] = self.0.denominator.with_cofactors(&other.0.denominator);
        // In this unit both contents are whole numbers, and so are the coefficients of the sum.
        let below_both = small::common_multiple(self.0.content.denom(), c.denom());
        let whole =
            |content: &BigRational| BigRational::from_integer(content.numer() * (&below_both / content.denom()));
        let term = (&self.0.numerator * &other_below).scaled(&whole(&self.0.content));
        let numerator = &term + &(&other.0.numerator * &below).scaled(&whole(c));
        let unit = BigRational::new_raw(BigInt::one(), below_both);
        if numerator.is_zero() {
            return Fraction::number(BigRational::zero(), self.variables());
        }
        let [_, numerator, shared] = numerator.with_cofactors(&shared);
        let content = small::product(&numerator.content(), &unit);
        Fraction::of(content, numerator.primitive(), &(&below * &other_below) * &shared)
    }

    /// The product: only a numerator and the denominator of the other can cancel.
    fn times(&self, other: &Fraction) -> Fraction {
        if self.is_zero() || other.is_zero() {
            return Fraction::number(BigRational::zero(), self.variables());
        }
        let [_, above, other_below] = self.0.numerator.with_cofactors(&other.0.denominator);
        let [_, other_above, below] = other.0.numerator.with_cofactors(&self.0.denominator);
        let content = small::product(&self.0.content, &other.0.content);
        Fraction::of(content, &above * &other_above, &below * &other_below)
    }
}

impl Neg for Fraction {
    type Output = Fraction;

    fn neg(self) -> Fraction {
        self.of_content(-&self.0.content)
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

operator!(Add, add, a, b => a.plus(&b.0.content, b));
operator!(Sub, sub, a, b => a.plus(&-&b.0.content, b));
operator!(Mul, mul, a, b => a.times(b));
operator!(Div, div, a, b => a.times(&b.inverse()));
