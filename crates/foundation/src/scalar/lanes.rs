//! Several `f64` side by side, as many as one register of the machine holds. The width is found at run time.

use super::{Real, Scalar};
use pulp::{Simd, WithSimd, bytemuck};
use std::ops::{Add, Div, Mul, Sub};

/// One number for each of [`Lanes::COUNT`](Packed::COUNT) elements.
#[derive(Debug, Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

/// Several `f64` that are computed together.
pub trait Packed: Real {
    /// How many numbers there are.
    const COUNT: usize;

    /// The numbers; shape `[COUNT]`.
    fn as_slice(&self) -> &[f64];

    /// The numbers, to be changed; shape `[COUNT]`.
    fn as_mut_slice(&mut self) -> &mut [f64];
}

impl<S: Simd> Packed for Lanes<S> {
    const COUNT: usize = S::F64_LANES;

    #[inline(always)]
    fn as_slice(&self) -> &[f64] {
        bytemuck::cast_slice(std::slice::from_ref(&self.values))
    }

    #[inline(always)]
    fn as_mut_slice(&mut self) -> &mut [f64] {
        bytemuck::cast_slice_mut(std::slice::from_mut(&mut self.values))
    }
}

/// A single number: the fallback for machines without wider registers.
impl Packed for f64 {
    const COUNT: usize = 1;

    #[inline(always)]
    fn as_slice(&self) -> &[f64] {
        std::slice::from_ref(self)
    }

    #[inline(always)]
    fn as_mut_slice(&mut self) -> &mut [f64] {
        std::slice::from_mut(self)
    }
}

/// A computation that is written once for every width of registers.
pub trait PackedWork {
    /// What the computation returns.
    type Output;

    /// Runs the computation. `zero` selects the kind of number.
    fn run<T: Packed>(self, zero: T) -> Self::Output;
}

/// Runs `work` with the widest registers of this machine.
pub fn widest<W: PackedWork>(work: W) -> W::Output {
    match pulp::Arch::new() {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        pulp::Arch::V4(simd) => work.run(Lanes::splat(simd, 0.0)),
        _ => at_most_four(work),
    }
}

/// Runs `work` with registers of at most four numbers. Gradients keep so many numbers at once that wider registers are no faster, and code for
/// them would only cost time to compile.
pub fn at_most_four<W: PackedWork>(work: W) -> W::Output {
    match pulp::Arch::new() {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        pulp::Arch::V4(simd) => work.run(Lanes::splat(*simd, 0.0)),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        pulp::Arch::V3(simd) => work.run(Lanes::splat(simd, 0.0)),
        #[cfg(target_arch = "aarch64")]
        pulp::Arch::Neon(simd) => work.run(Lanes::splat(simd, 0.0)),
        _ => work.run(0.0),
    }
}

/// Runs `work`, on plain numbers, compiled for the widest registers of this machine.
#[inline(always)]
pub fn dispatched<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

impl<S: Simd> Lanes<S> {
    /// Puts one value into every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Lanes<S> {
        Lanes { simd, values: simd.splat_f64s(value) }
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

    const UNROLLED: bool = true;

    // Array literals instead of a closure: a closure might not be inlined into the function that is compiled for the
    // machine's instructions.
    #[inline(always)]
    fn repeated<const N: usize>(&self) -> [Lanes<S>; N] {
        [*self; N]
    }

    #[inline(always)]
    fn repeated_rows<const A: usize, const B: usize>(&self) -> [[Lanes<S>; B]; A] {
        [[*self; B]; A]
    }

    #[inline(never)]
    fn vectorize<R>(&self, work: impl FnOnce() -> R) -> R {
        self.simd.vectorize(Work(work))
    }

    #[inline(always)]
    fn exact(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn epsilon() -> f64 {
        // Rounding to the nearest number errs by half of the distance of two numbers.
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
    fn rounded(&self) -> f64 {
        self.as_slice()[0]
    }

    #[inline(always)]
    fn choose(&self, yes: &Lanes<S>, no: &Lanes<S>) -> Lanes<S> {
        let positive = self.simd.greater_than_f64s(self.values, self.simd.splat_f64s(0.0));
        Lanes { simd: self.simd, values: self.simd.select_f64s(positive, yes.values, no.values) }
    }
}

/// Runs `work` with instructions that round `a b + c` only once, if the machine has them.
pub(super) fn with_fused_products<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(simd) = pulp::x86::V3::try_new() {
        return Simd::vectorize(simd, Work(work));
    }
    work()
}

struct Work<F>(F);

impl<R, F: FnOnce() -> R> WithSimd for Work<F> {
    type Output = R;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> R {
        (self.0)()
    }
}
