//! The value of an expression at rational functions.

use super::super::Expr;
use super::Fraction;
use num_rational::BigRational;
use num_traits::ToPrimitive;

/// The largest exponent of a power that is multiplied out.
const LARGEST_POWER: i32 = 64;

impl Expr {
    /// The value where the variables of the expression are these fractions; `None` if it takes roots or other functions than the four
    /// operations, or at a pole.
    pub fn fraction(&self, at: &[Fraction]) -> Option<Fraction> {
        let variables = at.first()?.variables();
        let integer = |c: i64| Fraction::number(BigRational::from_integer(c.into()), variables);
        match self {
            Expr::Number(c) => Some(Fraction::number(c.clone(), variables)),
            Expr::Variable(v) => at.get(*v).cloned(),
            Expr::Sum(terms) => terms.iter().try_fold(integer(0), |sum, term| Some(sum + &term.fraction(at)?)),
            Expr::Product(factors) => {
                factors.iter().try_fold(integer(1), |product, factor| Some(product * &factor.fraction(at)?))
            }
            Expr::Power(base, exponent) => {
                let n = exponent.to_i32().filter(|n| exponent.is_integer() && n.abs() <= LARGEST_POWER)?;
                let base = base.fraction(at)?;
                // Zero has no reciprocal.
                if n < 0 && base.is_zero() {
                    return None;
                }
                let base = if n < 0 { base.inverse() } else { base };
                Some((0..n.abs()).fold(integer(1), |power, _| power * &base))
            }
            Expr::Call(..) => None,
        }
    }
}
