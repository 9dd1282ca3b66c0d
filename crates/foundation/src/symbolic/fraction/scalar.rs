//! [`Fraction`] as a number of the kernels.

use super::Fraction;
use super::small::product;
use crate::scalar::Scalar;
use num_rational::BigRational;

impl Scalar for Fraction {
    type Constant = BigRational;

    fn exact(value: f64) -> BigRational {
        BigRational::from_float(value).expect("constants are finite")
    }

    fn epsilon() -> f64 {
        0.0
    }

    fn constant(&self, c: &BigRational) -> Fraction {
        Fraction::number(c.clone(), self.variables())
    }

    fn scaled(self, c: &BigRational) -> Fraction {
        if num_traits::Zero::is_zero(c) {
            return self.constant(c);
        }
        self.of_content(product(self.content(), c))
    }

    fn plus_product(self, a: &Fraction, b: &Fraction) -> Fraction {
        if a.is_zero() || b.is_zero() { self } else { self + &(a * b) }
    }

    fn minus_product(self, a: &Fraction, b: &Fraction) -> Fraction {
        if a.is_zero() || b.is_zero() { self } else { self - &(a * b) }
    }

    /// Compares the values at the point 1, 9/8, 10/9, …; false at a pole. Functions have no natural order. But side
    /// lengths are positive, and the answer only decides whether a pivot is zero, which at equal lengths might be a
    /// coincidence.
    fn exceeds(&self, other: &Fraction) -> bool {
        let place = |v: usize| {
            if v == 0 { BigRational::from_integer(1.into()) } else { BigRational::new((v + 8).into(), (v + 7).into()) }
        };
        let at: Vec<BigRational> = (0..self.variables()).map(place).collect();
        match (self.evaluate(&at), other.evaluate(&at)) {
            (Some(a), Some(b)) => a > b,
            _ => false,
        }
    }
}
