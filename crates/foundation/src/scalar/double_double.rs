//! Double-double numbers, with twice the digits of `f64`: the reference against which rounding errors are measured.
//! Also `f32`, with half the digits.
//!
//! Theory: page *Precision* of the book.

use super::lanes::with_fused_products;
use super::{Real, Scalar};
use std::ops::{Add, Div, Mul, Sub};

/// `hi + lo`, with |lo| at most half a unit in the last place of `hi`: 32 decimal digits in the range of `f64`.
///
/// Sum and product are algorithms 6 and 12 of Joldes, Muller, Popescu, ACM Trans. Math. Softw. 44 (2017). The quotient
/// adds a third digit by long division; the square root is one step of Newton's method (Karp and Markstein 1997).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleDouble {
    /// The nearest `f64`.
    pub hi: f64,
    /// The rest.
    pub lo: f64,
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> DoubleDouble {
        DoubleDouble { hi: value, lo: 0.0 }
    }
}

/// `a + b`, exactly.
#[inline(always)]
fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    let other = hi - a;
    DoubleDouble { hi, lo: (a - (hi - other)) + (b - other) }
}

/// `a + b`, exactly, for |a| ≥ |b|.
#[inline(always)]
fn fast_two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    DoubleDouble { hi, lo: b - (hi - a) }
}

impl DoubleDouble {
    #[inline(always)]
    fn times(self, y: f64) -> DoubleDouble {
        let high = self.hi * y;
        // The fused product minus its rounded value is the rounding error of the product, exactly.
        let low = self.lo.mul_add(y, self.hi.mul_add(y, -high));
        fast_two_sum(high, low)
    }
}

impl Add<&DoubleDouble> for DoubleDouble {
    type Output = DoubleDouble;

    #[inline(always)]
    fn add(self, y: &DoubleDouble) -> DoubleDouble {
        let (s, t) = (two_sum(self.hi, y.hi), two_sum(self.lo, y.lo));
        let v = fast_two_sum(s.hi, s.lo + t.hi);
        fast_two_sum(v.hi, t.lo + v.lo)
    }
}

impl Sub<&DoubleDouble> for DoubleDouble {
    type Output = DoubleDouble;

    #[inline(always)]
    fn sub(self, y: &DoubleDouble) -> DoubleDouble {
        self + &DoubleDouble { hi: -y.hi, lo: -y.lo }
    }
}

impl Mul<&DoubleDouble> for DoubleDouble {
    type Output = DoubleDouble;

    #[inline(always)]
    fn mul(self, y: &DoubleDouble) -> DoubleDouble {
        let high = self.hi * y.hi;
        let rest = self.hi.mul_add(y.hi, -high);
        let low = self.lo.mul_add(y.hi, self.hi.mul_add(y.lo, self.lo * y.lo));
        fast_two_sum(high, rest + low)
    }
}

impl Div<&DoubleDouble> for DoubleDouble {
    type Output = DoubleDouble;

    #[inline(always)]
    fn div(self, y: &DoubleDouble) -> DoubleDouble {
        let first = self.hi / y.hi;
        let rest = self - &y.times(first);
        let second = rest.hi / y.hi;
        let third = (rest - &y.times(second)).hi / y.hi;
        // The third digit makes the quotient about as accurate as the other operations.
        fast_two_sum(first, second) + &DoubleDouble::from(third)
    }
}

impl Scalar for DoubleDouble {
    type Constant = f64;

    fn exact(value: f64) -> f64 {
        value
    }

    /// The bound of the quotient, 10·2⁻¹⁰⁶; those of the other three operations are smaller.
    fn epsilon() -> f64 {
        10.0 * 2f64.powi(-106)
    }

    /// Enables the fused multiply-add instructions of the machine, which make products exact in one operation.
    #[inline(never)]
    fn vectorize<R>(&self, work: impl FnOnce() -> R) -> R {
        with_fused_products(work)
    }

    fn given() -> f64 {
        // Coordinates and tables are doubles, however many digits the computation has.
        f64::EPSILON / 2.0
    }

    fn constant(&self, c: &f64) -> DoubleDouble {
        DoubleDouble::from(*c)
    }

    #[inline(always)]
    fn scaled(self, c: &f64) -> DoubleDouble {
        self.times(*c)
    }

    #[inline(always)]
    fn plus_product(self, a: &DoubleDouble, b: &DoubleDouble) -> DoubleDouble {
        self + &(*a * b)
    }

    #[inline(always)]
    fn minus_product(self, a: &DoubleDouble, b: &DoubleDouble) -> DoubleDouble {
        self - &(*a * b)
    }

    fn exceeds(&self, other: &DoubleDouble) -> bool {
        (*self - other).hi > 0.0
    }
}

impl Real for DoubleDouble {
    fn sqrt(self) -> DoubleDouble {
        let root = self.hi.sqrt();
        // Newton's step would divide zero by zero; roots that are no numbers stay what they are.
        if !(root > 0.0) {
            return DoubleDouble::from(root);
        }
        let rest = self - &DoubleDouble::from(root).times(root);
        fast_two_sum(root, rest.hi / (2.0 * root))
    }

    fn rounded(&self) -> f64 {
        self.hi
    }

    fn choose(&self, yes: &DoubleDouble, no: &DoubleDouble) -> DoubleDouble {
        // `lo` is at most half a unit of `hi`, so that the sign is that of `hi`.
        if self.hi > 0.0 { *yes } else { *no }
    }
}

impl Scalar for f32 {
    type Constant = f64;

    fn exact(value: f64) -> f64 {
        value
    }

    fn epsilon() -> f64 {
        f64::from(f32::EPSILON) / 2.0
    }

    fn constant(&self, c: &f64) -> f32 {
        *c as f32
    }

    fn scaled(self, c: &f64) -> f32 {
        self * *c as f32
    }

    fn plus_product(self, a: &f32, b: &f32) -> f32 {
        self + a * b
    }

    fn minus_product(self, a: &f32, b: &f32) -> f32 {
        self - a * b
    }

    fn exceeds(&self, other: &f32) -> bool {
        self > other
    }
}

impl Real for f32 {
    fn sqrt(self) -> f32 {
        f32::sqrt(self)
    }

    fn rounded(&self) -> f64 {
        f64::from(*self)
    }

    fn choose(&self, yes: &f32, no: &f32) -> f32 {
        if *self > 0.0 { *yes } else { *no }
    }
}
