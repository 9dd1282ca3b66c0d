//! Double-double numbers, with twice the digits of `f64`: the reference against which rounding errors are measured.
//! Also `f32`, with half the digits.
//!
//! Theory: page *Precision* of the book.

use super::groups::{Group, GroupWork};
use super::lanes::with_fused_products;
use super::{Real, Scalar};
use pulp::{Simd, WithSimd, bytemuck};
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

/// One of the two parts of a number, or of as many numbers as a register holds.
trait Part: Copy {
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    /// `self · b + c`, rounded only once.
    fn times_plus(self, b: Self, c: Self) -> Self;
    fn negated(self) -> Self;
}

impl Part for f64 {
    #[inline(always)]
    fn plus(self, other: f64) -> f64 {
        self + other
    }

    #[inline(always)]
    fn minus(self, other: f64) -> f64 {
        self - other
    }

    #[inline(always)]
    fn times(self, other: f64) -> f64 {
        self * other
    }

    #[inline(always)]
    fn times_plus(self, b: f64, c: f64) -> f64 {
        self.mul_add(b, c)
    }

    #[inline(always)]
    fn negated(self) -> f64 {
        -self
    }
}

/// A part of each of several numbers, with the instructions of its machine.
#[derive(Clone, Copy)]
struct Parts<S: Simd>(S, S::f64s);

impl<S: Simd> Part for Parts<S> {
    #[inline(always)]
    fn plus(self, other: Parts<S>) -> Parts<S> {
        Parts(self.0, self.0.add_f64s(self.1, other.1))
    }

    #[inline(always)]
    fn minus(self, other: Parts<S>) -> Parts<S> {
        Parts(self.0, self.0.sub_f64s(self.1, other.1))
    }

    #[inline(always)]
    fn times(self, other: Parts<S>) -> Parts<S> {
        Parts(self.0, self.0.mul_f64s(self.1, other.1))
    }

    #[inline(always)]
    fn times_plus(self, b: Parts<S>, c: Parts<S>) -> Parts<S> {
        Parts(self.0, self.0.mul_add_f64s(self.1, b.1, c.1))
    }

    #[inline(always)]
    fn negated(self) -> Parts<S> {
        Parts(self.0, self.0.neg_f64s(self.1))
    }
}

/// `a + b`, exactly.
#[inline(always)]
fn two_sum<P: Part>(a: P, b: P) -> [P; 2] {
    let hi = a.plus(b);
    let other = hi.minus(a);
    [hi, a.minus(hi.minus(other)).plus(b.minus(other))]
}

/// `a + b`, exactly, for |a| ≥ |b|.
#[inline(always)]
fn fast_two_sum<P: Part>(a: P, b: P) -> [P; 2] {
    let hi = a.plus(b);
    [hi, b.minus(hi.minus(a))]
}

/// `x + y`, of numbers of two parts, the larger one first.
#[inline(always)]
fn sum<P: Part>(x: [P; 2], y: [P; 2]) -> [P; 2] {
    let ([s, s_rest], [t, t_rest]) = (two_sum(x[0], y[0]), two_sum(x[1], y[1]));
    let [v, v_rest] = fast_two_sum(s, s_rest.plus(t));
    fast_two_sum(v, t_rest.plus(v_rest))
}

/// `x y`, of numbers of two parts.
#[inline(always)]
fn product<P: Part>(x: [P; 2], y: [P; 2]) -> [P; 2] {
    let high = x[0].times(y[0]);
    // The fused product minus its rounded value is the rounding error of the product, exactly.
    let rest = x[0].times_plus(y[0], high.negated());
    let low = x[1].times_plus(y[0], x[0].times_plus(y[1], x[1].times(y[1])));
    fast_two_sum(high, rest.plus(low))
}

impl DoubleDouble {
    #[inline(always)]
    fn of([hi, lo]: [f64; 2]) -> DoubleDouble {
        DoubleDouble { hi, lo }
    }

    #[inline(always)]
    fn parts(self) -> [f64; 2] {
        [self.hi, self.lo]
    }

    #[inline(always)]
    fn times(self, y: f64) -> DoubleDouble {
        let high = self.hi * y;
        let low = self.lo.mul_add(y, self.hi.mul_add(y, -high));
        DoubleDouble::of(fast_two_sum(high, low))
    }
}

impl Add<&DoubleDouble> for DoubleDouble {
    type Output = DoubleDouble;

    #[inline(always)]
    fn add(self, y: &DoubleDouble) -> DoubleDouble {
        DoubleDouble::of(sum(self.parts(), y.parts()))
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
        DoubleDouble::of(product(self.parts(), y.parts()))
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
        DoubleDouble::of(fast_two_sum(first, second)) + &DoubleDouble::from(third)
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
        DoubleDouble::of(fast_two_sum(root, rest.hi / (2.0 * root)))
    }

    fn rounded(&self) -> f64 {
        self.hi
    }

    fn grouped<W: GroupWork<DoubleDouble>>(&self, work: W) -> Result<W::Output, W> {
        match pulp::Arch::new() {
            // Without wider registers nothing is gained.
            pulp::Arch::Scalar => Err(work),
            machine => Ok(machine.dispatch(InGroups(work))),
        }
    }

    fn choose(&self, yes: &DoubleDouble, no: &DoubleDouble) -> DoubleDouble {
        // `lo` is at most half a unit of `hi`, so that the sign is that of `hi`.
        if self.hi > 0.0 { *yes } else { *no }
    }
}

/// As many double-double numbers as a register holds parts; each is what the operations of one number make it, to the last bit.
#[derive(Clone, Copy)]
struct DoubleDoubles<S: Simd>([Parts<S>; 2]);

struct InGroups<W>(W);

impl<W: GroupWork<DoubleDouble>> WithSimd for InGroups<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> W::Output {
        self.0.run(DoubleDoubles([Parts(simd, simd.splat_f64s(0.0)); 2]))
    }
}

impl<S: Simd> Group<DoubleDouble> for DoubleDoubles<S> {
    const COUNT: usize = S::F64_LANES;

    #[inline(always)]
    fn filled(self, number: &DoubleDouble) -> DoubleDoubles<S> {
        let Parts(simd, _) = self.0[0];
        DoubleDoubles([Parts(simd, simd.splat_f64s(number.hi)), Parts(simd, simd.splat_f64s(number.lo))])
    }

    #[inline(always)]
    fn load(mut self, from: &[DoubleDouble]) -> DoubleDoubles<S> {
        for (i, number) in from.iter().enumerate() {
            self.set(i, number);
        }
        self
    }

    #[inline(always)]
    fn set(&mut self, i: usize, number: &DoubleDouble) {
        let [Parts(_, hi), Parts(_, lo)] = &mut self.0;
        bytemuck::cast_slice_mut(std::slice::from_mut(hi))[i] = number.hi;
        bytemuck::cast_slice_mut(std::slice::from_mut(lo))[i] = number.lo;
    }

    #[inline(always)]
    fn get(&self, i: usize) -> DoubleDouble {
        let [Parts(_, hi), Parts(_, lo)] = &self.0;
        let part = |parts| bytemuck::cast_slice::<S::f64s, f64>(std::slice::from_ref(parts))[i];
        DoubleDouble { hi: part(hi), lo: part(lo) }
    }

    #[inline(always)]
    fn plus_product(self, a: DoubleDoubles<S>, b: DoubleDoubles<S>) -> DoubleDoubles<S> {
        DoubleDoubles(sum(self.0, product(a.0, b.0)))
    }

    #[inline(always)]
    fn minus_product(self, a: DoubleDoubles<S>, b: DoubleDoubles<S>) -> DoubleDoubles<S> {
        let [hi, lo] = product(a.0, b.0);
        DoubleDoubles(sum(self.0, [hi.negated(), lo.negated()]))
    }
}

impl Scalar for f32 {
    type Constant = f64;

    const ANISOTROPIC: bool = false;

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
