//! As many numbers side by side as one register of the machine holds, found out at run time.

use super::{Real, Scalar};
use pulp::{Simd, WithSimd, bytemuck};
use std::ops::{Add, Div, Mul, Sub};

/// One number per element, for [`Lanes::COUNT`] elements at once.
#[derive(Debug, Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

impl<S: Simd> Lanes<S> {
    pub const COUNT: usize = S::F64_LANES;

    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Lanes<S> {
        Lanes { simd, values: simd.splat_f64s(value) }
    }

    /// `[lanes]`.
    #[inline(always)]
    pub fn as_slice(&self) -> &[f64] {
        bytemuck::cast_slice(std::slice::from_ref(&self.values))
    }

    /// `[lanes]`.
    #[inline(always)]
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        bytemuck::cast_slice_mut(std::slice::from_mut(&mut self.values))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $instruction:ident) => {
        impl<S: Simd> $trait<&Lanes<S>> for Lanes<S> {
            type Output = Lanes<S>;

            #[inline(always)]
            fn $method(self, other: &Lanes<S>) -> Lanes<S> {
                Lanes { simd: self.simd, values: self.simd.$instruction(self.values, other.values) }
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

impl<S: Simd> Scalar for Lanes<S> {
    type Constant = f64;

    #[inline(always)]
    fn exact(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn epsilon() -> f64 {
        f64::EPSILON / 2.0
    }

    #[inline(always)]
    fn delicate() -> f64 {
        1e-3
    }

    #[inline(always)]
    fn constant(&self, c: &f64) -> Lanes<S> {
        Lanes::splat(self.simd, *c)
    }

    #[inline(always)]
    fn scaled(self, c: &f64) -> Lanes<S> {
        self * &Lanes::splat(self.simd, *c)
    }

    #[inline(always)]
    fn plus_product(self, a: &Lanes<S>, b: &Lanes<S>) -> Lanes<S> {
        Lanes { simd: self.simd, values: self.simd.mul_add_e_f64s(a.values, b.values, self.values) }
    }

    #[inline(always)]
    fn minus_product(self, a: &Lanes<S>, b: &Lanes<S>) -> Lanes<S> {
        Lanes { simd: self.simd, values: self.simd.negate_mul_add_e_f64s(a.values, b.values, self.values) }
    }

    #[inline(always)]
    fn exceeds(&self, other: &Lanes<S>) -> bool {
        let above = self.simd.greater_than_f64s(self.values, other.values);
        let marks = self.simd.select_f64s(above, self.simd.splat_f64s(1.0), self.simd.splat_f64s(0.0));
        bytemuck::cast_slice::<S::f64s, f64>(&[marks]).iter().all(|mark| *mark == 1.0)
    }
}

impl<S: Simd> Real for Lanes<S> {
    #[inline(always)]
    fn sqrt(self) -> Lanes<S> {
        Lanes { simd: self.simd, values: self.simd.sqrt_f64s(self.values) }
    }

    #[inline(always)]
    fn vectorize<R>(&self, work: impl FnOnce() -> R) -> R {
        self.simd.vectorize(Work(work))
    }

    #[inline(always)]
    fn rounded(&self) -> f64 {
        self.as_slice()[0]
    }

    #[inline(always)]
    fn choose(&self, yes: &Lanes<S>, no: &Lanes<S>) -> Lanes<S> {
        let positive = self.simd.greater_than_f64s(self.values, self.simd.splat_f64s(0.0));
        Lanes { simd: self.simd, values: self.simd.select_f64s(positive, yes.values, no.values) }
    }
}

pub(super) struct Work<F>(pub F);

impl<R, F: FnOnce() -> R> WithSimd for Work<F> {
    type Output = R;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> R {
        (self.0)()
    }
}
