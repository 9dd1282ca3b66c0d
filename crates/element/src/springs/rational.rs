//! What springs on functions contribute to formulas: `∇c ∇cᵀ` without roots.
//!
//! Theory: page *Least squares* of the book.

use super::FunctionSpring;
use super::angle::{angle_normal, angle_row};
use crate::element::SpringKind;
use crate::scalar::Scalar;
use crate::symbolic::{Expr, Fraction};
use num_rational::BigRational;

impl FunctionSpring {
    /// The vector r, `[points × dimension]`, and the number q with `∇c ∇cᵀ = q r rᵀ`, both rational functions of what the points at `x`,
    /// `[points × dimension]`, depend on. A measure `c = f √Q` with a number f and a rational function Q has `r = ∇Q`, `q = f²/(4 Q)`.
    ///
    /// None if this takes roots, or where c has no gradient.
    pub fn rational_row(&self, x: &[Fraction], dimension: usize) -> Option<(Vec<Fraction>, Fraction)> {
        if self.kind == SpringKind::Angle {
            let is_bent = angle_normal(x, dimension).iter().any(|entry| !entry.is_zero());
            return is_bent.then(|| angle_row(x, dimension));
        }
        let gradient = |function: &Expr| -> Option<Vec<Fraction>> {
            (0..x.len()).map(|variable| function.derivative(variable).fraction(x)).collect()
        };
        if let Some(row) = gradient(&self.function) {
            return Some((row, x[0].one()));
        }
        let (factor, inside) = scaled_root(&self.function)?;
        let value = inside.fraction(x).filter(|value| !value.is_zero())?;
        let four = BigRational::from_integer(4.into());
        Some((gradient(inside)?, (value.one() / &value).scaled(&(&factor * &factor / four))))
    }
}

/// f and Q of `f √Q`.
fn scaled_root(function: &Expr) -> Option<(BigRational, &Expr)> {
    let half = BigRational::new(1.into(), 2.into());
    match function {
        Expr::Power(inside, exponent) if *exponent == half => Some((BigRational::from_integer(1.into()), inside)),
        Expr::Product(factors) => match factors.as_slice() {
            [Expr::Number(factor), Expr::Power(inside, exponent)] if *exponent == half => {
                Some((factor.clone(), inside))
            }
            _ => None,
        },
        _ => None,
    }
}
