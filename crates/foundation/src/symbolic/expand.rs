//! Expansion of expressions into polynomials, with bounds on the work.

use super::{Expr, Polynomial};
use num_rational::BigRational;
use num_traits::{One, ToPrimitive};

/// The largest number of terms, well above that of any shape function. Larger expansions are given up.
const MOST_TERMS: usize = 5000;
/// The largest degree of an expansion.
// The largest rule integrates the degree 63: the bound is far above what is of use, and keeps a text such as `x^4000000000` from
// hours of work.
const LARGEST_DEGREE: u32 = 1000;
/// The largest power of a sum that is expanded.
const LARGEST_POWER: u32 = 64;
/// The largest number of binary digits of a coefficient.
const MOST_BITS: u64 = 8000;
/// The largest number of sums and products of short coefficients over all steps of an expansion; this takes about a
/// fifth of a second.
const MOST_WORK: u64 = 400_000;

impl Polynomial {
    /// The expansion of `expr` in `variables` variables, or `None` if it is not a polynomial of moderate size.
    pub fn expand(expr: &Expr, variables: usize) -> Option<Polynomial> {
        Expansion { variables, work_left: MOST_WORK }.of(expr)
    }
}

struct Expansion {
    variables: usize,
    work_left: u64,
}

impl Expansion {
    fn of(&mut self, expr: &Expr) -> Option<Polynomial> {
        match expr {
            Expr::Number(c) => Some(Polynomial::constant(c.clone(), self.variables)),
            Expr::Variable(v) => Some(Polynomial::variable(*v, self.variables)),
            Expr::Sum(terms) => terms.iter().try_fold(Polynomial::default(), |sum, t| {
                let term = self.of(t)?;
                self.plus(&sum, &term)
            }),
            Expr::Product(factors) => factors.iter().try_fold(self.one(), |product, f| {
                let factor = self.of(f)?;
                self.times(&product, &factor)
            }),
            Expr::Power(base, exponent) => {
                let n = exponent.to_u32().filter(|n| exponent.is_integer() && *n <= LARGEST_POWER)?;
                let base = self.of(base)?;
                (0..n).try_fold(self.one(), |power, _| self.times(&power, &base))
            }
            Expr::Call(..) => None,
        }
    }

    fn one(&self) -> Polynomial {
        Polynomial::constant(BigRational::one(), self.variables)
    }

    fn plus(&mut self, p: &Polynomial, q: &Polynomial) -> Option<Polynomial> {
        self.spend(p.term_count() + q.term_count(), p.largest_bits().max(q.largest_bits()))?;
        Some(p + q).filter(|sum| sum.term_count() <= MOST_TERMS)
    }

    fn times(&mut self, p: &Polynomial, q: &Polynomial) -> Option<Polynomial> {
        let products = p.term_count() * q.term_count();
        if products > 10 * MOST_TERMS || p.degree() + q.degree() > LARGEST_DEGREE {
            return None;
        }
        self.spend(products, p.largest_bits() + q.largest_bits())?;
        Some(p * q).filter(|product| product.term_count() <= MOST_TERMS)
    }

    /// Counts the work of `operations` on numbers of `bits` binary digits; `None` if the numbers are too long or the
    /// work is too much.
    fn spend(&mut self, operations: usize, bits: u64) -> Option<()> {
        // A sum of fractions requires a greatest common divisor, which takes one pass over the digits for each digit.
        let each = 1 + bits / 16 + (bits / 256).pow(2);
        self.work_left = self.work_left.checked_sub((operations as u64).saturating_mul(each))?;
        (bits <= MOST_BITS).then_some(())
    }
}
