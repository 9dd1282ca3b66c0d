//! The three coordinates of a point in one register, for loops over springs and cells that share points.
//!
//! Such loops read and write points at scattered places. With one cell per SIMD lane, every number would be gathered
//! and scattered one by one; with one point per register it is loaded and stored at once.

#[cfg(target_arch = "x86_64")]
use pulp::{Simd, WithSimd, cast, x86::V3};
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::__m256d;

/// A vector of three coordinates and one unused entry. Where a method makes a new vector, `self` only selects the kind
/// of register.
pub trait Coordinates: Copy {
    /// Reads four numbers.
    fn load(self, from: &[f64; 4]) -> Self;

    /// Writes four numbers.
    fn store(self, to: &mut [f64; 4]);

    /// Reads four numbers of single precision.
    fn load_single(self, from: &[f32; 4]) -> Self;

    /// Writes four numbers, rounded to single precision.
    fn store_single(self, to: &mut [f32; 4]);

    /// `self + other`.
    fn plus(self, other: Self) -> Self;

    /// `self − other`.
    fn minus(self, other: Self) -> Self;

    /// `factor · self`.
    fn scaled(self, factor: f64) -> Self;

    /// `self + factor · other`.
    fn plus_scaled(self, factor: f64, other: Self) -> Self;

    /// `self + a b` for each coordinate.
    fn plus_products(self, a: Self, b: Self) -> Self;

    /// The cyclic permutation `(y, z, x)` of `(x, y, z)`, from which cross products are built.
    fn turned(self) -> Self;

    /// `a b − c d` for each coordinate, with `self` as `a`.
    fn difference_of_products(self, b: Self, c: Self, d: Self) -> Self;

    /// The sum of all four entries of each vector.
    fn sums(vectors: [Self; 4]) -> Self;

    /// The scalar product `x x' + y y' + z z'`.
    fn dot(self, other: Self) -> f64;
}

/// A computation that is written once for every kind of register.
pub trait CoordinatesWork {
    /// What the computation returns.
    type Output;

    /// Runs the computation. `zero` selects the kind of register.
    fn run<C: Coordinates>(self, zero: C) -> Self::Output;
}

/// Runs `work` with one register per point if the machine has AVX2, and with arrays otherwise.
pub fn with_coordinates<W: CoordinatesWork>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = V3::try_new() {
        return Simd::vectorize(simd, Wide(simd, work));
    }
    work.run([0.0; 4])
}

#[cfg(target_arch = "x86_64")]
struct Wide<W>(V3, W);

#[cfg(target_arch = "x86_64")]
impl<W: CoordinatesWork> WithSimd for Wide<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> W::Output {
        self.1.run(Register { simd: self.0, values: self.0.splat_f64x4(0.0) })
    }
}

/// Uses explicit instructions: from operations on the entries of an array the compiler forms pairs and shuffles between
/// them.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Register {
    simd: V3,
    values: pulp::f64x4,
}

#[cfg(target_arch = "x86_64")]
impl Register {
    #[inline(always)]
    fn of(self, values: pulp::f64x4) -> Register {
        Register { simd: self.simd, values }
    }
}

#[cfg(target_arch = "x86_64")]
impl Coordinates for Register {
    #[inline(always)]
    fn load(self, from: &[f64; 4]) -> Register {
        self.of(cast(*from))
    }

    #[inline(always)]
    fn store(self, to: &mut [f64; 4]) {
        *to = cast(self.values);
    }

    #[inline(always)]
    fn load_single(self, from: &[f32; 4]) -> Register {
        self.of(cast(self.simd.avx._mm256_cvtps_pd(cast(*from))))
    }

    #[inline(always)]
    fn store_single(self, to: &mut [f32; 4]) {
        *to = cast(self.simd.avx._mm256_cvtpd_ps(cast(self.values)));
    }

    #[inline(always)]
    fn plus(self, other: Register) -> Register {
        self.of(self.simd.add_f64x4(self.values, other.values))
    }

    #[inline(always)]
    fn minus(self, other: Register) -> Register {
        self.of(self.simd.sub_f64x4(self.values, other.values))
    }

    #[inline(always)]
    fn scaled(self, factor: f64) -> Register {
        self.of(self.simd.mul_f64x4(self.values, self.simd.splat_f64x4(factor)))
    }

    #[inline(always)]
    fn plus_scaled(self, factor: f64, other: Register) -> Register {
        self.of(self.simd.mul_add_f64x4(self.simd.splat_f64x4(factor), other.values, self.values))
    }

    #[inline(always)]
    fn plus_products(self, a: Register, b: Register) -> Register {
        self.of(self.simd.mul_add_f64x4(a.values, b.values, self.values))
    }

    #[inline(always)]
    fn turned(self) -> Register {
        let values: __m256d = cast(self.values);
        self.of(cast(self.simd.avx2._mm256_permute4x64_pd::<0b11_00_10_01>(values)))
    }

    #[inline(always)]
    fn difference_of_products(self, b: Register, c: Register, d: Register) -> Register {
        self.of(self.simd.mul_sub_f64x4(self.values, b.values, self.simd.mul_f64x4(c.values, d.values)))
    }

    #[inline(always)]
    fn sums([a, b, c, d]: [Register; 4]) -> Register {
        let avx = a.simd.avx;
        let pairs = |a: Register, b: Register| avx._mm256_hadd_pd(cast(a.values), cast(b.values));
        let (ab, cd) = (pairs(a, b), pairs(c, d));
        let lower = avx._mm256_permute2f128_pd::<0x20>(ab, cd);
        let upper = avx._mm256_permute2f128_pd::<0x31>(ab, cd);
        a.of(a.simd.add_f64x4(cast(lower), cast(upper)))
    }

    #[inline(always)]
    fn dot(self, other: Register) -> f64 {
        let products: [f64; 4] = cast(self.simd.mul_f64x4(self.values, other.values));
        products[0] + products[1] + products[2]
    }
}

/// For machines without such registers.
impl Coordinates for [f64; 4] {
    #[inline(always)]
    fn load(self, from: &[f64; 4]) -> [f64; 4] {
        *from
    }

    #[inline(always)]
    fn store(self, to: &mut [f64; 4]) {
        *to = self;
    }

    #[inline(always)]
    fn load_single(self, from: &[f32; 4]) -> [f64; 4] {
        from.map(f64::from)
    }

    #[inline(always)]
    fn store_single(self, to: &mut [f32; 4]) {
        *to = self.map(|x| x as f32);
    }

    #[inline(always)]
    fn plus(self, other: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| self[k] + other[k])
    }

    #[inline(always)]
    fn minus(self, other: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| self[k] - other[k])
    }

    #[inline(always)]
    fn scaled(self, factor: f64) -> [f64; 4] {
        self.map(|x| x * factor)
    }

    #[inline(always)]
    fn plus_scaled(self, factor: f64, other: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| self[k] + factor * other[k])
    }

    #[inline(always)]
    fn plus_products(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| self[k] + a[k] * b[k])
    }

    #[inline(always)]
    fn turned(self) -> [f64; 4] {
        [self[1], self[2], self[0], self[3]]
    }

    #[inline(always)]
    fn difference_of_products(self, b: [f64; 4], c: [f64; 4], d: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| self[k] * b[k] - c[k] * d[k])
    }

    #[inline(always)]
    fn sums(vectors: [[f64; 4]; 4]) -> [f64; 4] {
        vectors.map(|vector| vector.iter().sum())
    }

    #[inline(always)]
    fn dot(self, other: [f64; 4]) -> f64 {
        self[0] * other[0] + self[1] * other[1] + self[2] * other[2]
    }
}
