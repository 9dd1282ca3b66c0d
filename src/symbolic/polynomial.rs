//! Polynomials with rational coefficients: where an expression is one, its identities are decided, not sampled.

use super::Expr;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};
use std::collections::BTreeMap;

/// More terms than any element needs; an expansion beyond it is given up.
const MOST_TERMS: usize = 5000;

/// `Σ c · x₀^e₀ x₁^e₁ …` with the exponents as keys and no zero coefficients.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Polynomial {
    terms: BTreeMap<Vec<u32>, BigRational>,
}

impl Polynomial {
    /// The expansion of `expr` in `variables` variables, or `None` if it is not a polynomial of moderate size.
    pub fn expand(expr: &Expr, variables: usize) -> Option<Polynomial> {
        let constant = |c: &BigRational| Polynomial::monomial(vec![0; variables], c.clone());
        match expr {
            Expr::Number(c) => Some(constant(c)),
            Expr::Variable(v) => {
                let mut exponents = vec![0; variables];
                exponents[*v] = 1;
                Some(Polynomial::monomial(exponents, BigRational::one()))
            }
            Expr::Sum(terms) => {
                let mut sum = Polynomial::default();
                for term in terms {
                    for (e, c) in Polynomial::expand(term, variables)?.terms {
                        sum.add_term(e, c);
                    }
                }
                Some(sum)
            }
            Expr::Product(factors) => factors
                .iter()
                .try_fold(constant(&BigRational::one()), |p, f| p.times(&Polynomial::expand(f, variables)?)),
            Expr::Power(base, exponent) => {
                let n = exponent.to_u32().filter(|n| exponent.is_integer() && *n <= 64)?;
                let base = Polynomial::expand(base, variables)?;
                (0..n).try_fold(constant(&BigRational::one()), |p, _| p.times(&base))
            }
            Expr::Call(..) => None,
        }
    }

    fn monomial(exponents: Vec<u32>, coefficient: BigRational) -> Polynomial {
        let mut p = Polynomial::default();
        p.add_term(exponents, coefficient);
        p
    }

    fn add_term(&mut self, exponents: Vec<u32>, coefficient: BigRational) {
        let sum = self.terms.remove(&exponents).unwrap_or_else(BigRational::zero) + coefficient;
        if !sum.is_zero() {
            self.terms.insert(exponents, sum);
        }
    }

    fn times(&self, other: &Polynomial) -> Option<Polynomial> {
        let mut product = Polynomial::default();
        for (e, c) in &self.terms {
            for (f, d) in &other.terms {
                product.add_term(e.iter().zip(f).map(|(a, b)| a + b).collect(), c * d);
            }
            if product.terms.len() > MOST_TERMS {
                return None;
            }
        }
        Some(product)
    }

    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The largest sum of exponents of a term.
    pub fn degree(&self) -> u32 {
        self.terms.keys().map(|e| e.iter().sum()).max().unwrap_or(0)
    }
}
