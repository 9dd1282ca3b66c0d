use super::{Expr, Polynomial};
use num_rational::BigRational;
use num_traits::{One, ToPrimitive};

/// More terms than any element needs, and a higher degree; an expansion beyond them is given up.
const MOST_TERMS: usize = 5000;
const LARGEST_DEGREE: u32 = 1000;

impl Polynomial {
    /// The expansion of `expr` in `variables` variables, or `None` if it is not a polynomial of moderate size.
    pub fn expand(expr: &Expr, variables: usize) -> Option<Polynomial> {
        let one = || Polynomial::constant(BigRational::one(), variables);
        let times = |p: Polynomial, q: &Polynomial| {
            let moderate =
                p.term_count() * q.term_count() <= 10 * MOST_TERMS && p.degree() + q.degree() <= LARGEST_DEGREE;
            moderate.then(|| &p * q).filter(|product| product.term_count() <= MOST_TERMS)
        };
        match expr {
            Expr::Number(c) => Some(Polynomial::constant(c.clone(), variables)),
            Expr::Variable(v) => Some(Polynomial::variable(*v, variables)),
            Expr::Sum(terms) => {
                terms.iter().try_fold(Polynomial::default(), |sum, t| Some(&sum + &Polynomial::expand(t, variables)?))
            }
            Expr::Product(factors) => {
                factors.iter().try_fold(one(), |p, f| times(p, &Polynomial::expand(f, variables)?))
            }
            Expr::Power(base, exponent) => {
                let n = exponent.to_u32().filter(|n| exponent.is_integer() && *n <= 64)?;
                let base = Polynomial::expand(base, variables)?;
                (0..n).try_fold(one(), |p, _| times(p, &base))
            }
            Expr::Call(..) => None,
        }
    }
}
