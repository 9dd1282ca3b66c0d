//! Four coordinates in a register of the machine, one kind for each kind of number.

use super::coordinates::{Coordinate, CoordinatesWork};

#[cfg(target_arch = "x86_64")]
use {
    super::coordinates::Coordinates,
    pulp::{Simd, WithSimd, cast, f32x4, f64x4, x86::V3},
    std::arch::x86_64::{__m128, __m256d},
};

/// Uses explicit instructions: from operations on the entries of an array the compiler forms pairs and shuffles between
/// them.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Register<V> {
    simd: V3,
    values: V,
}

#[cfg(target_arch = "x86_64")]
impl<V> Register<V> {
    #[inline(always)]
    fn of(self, values: V) -> Register<V> {
        Register { simd: self.simd, values }
    }
}

/// Registers of one kind of number: its vector, its instructions, the one that turns a vector of the machine, and what has no name in
/// common.
macro_rules! registers {
    (
        $number:ty, $work:ident, $vector:ty, $splat:ident, $add:ident, $sub:ident, $mul:ident, $mul_add:ident, $mul_sub:ident,
        $set:ident.$turn:ident($machine:ty), { $($own:tt)* }
    ) => {
        impl Coordinate for $number {
            const IS_SHORT: bool = <$number>::DIGITS < f64::DIGITS;

            #[inline(always)]
            fn of(x: f64) -> $number {
                x as $number
            }

            #[inline(always)]
            fn wide(self) -> f64 {
                self.into()
            }

            fn with_coordinates<W: CoordinatesWork<$number>>(work: W) -> W::Output {
                #[cfg(target_arch = "x86_64")]
                if let Some(simd) = V3::try_new() {
                    return Simd::vectorize(simd, $work(simd, work));
                }
                // Machines without these instructions, and other processors, run the same work on plain arrays.
                work.run([0.0; 4])
            }
        }

        #[cfg(target_arch = "x86_64")]
        struct $work<W>(V3, W);

        #[cfg(target_arch = "x86_64")]
        impl<W: CoordinatesWork<$number>> WithSimd for $work<W> {
            type Output = W::Output;

            #[inline(always)]
            fn with_simd<S: Simd>(self, _: S) -> W::Output {
                let $work(simd, work) = self;
                work.run(Register { simd, values: simd.$splat(0.0) })
            }
        }

        #[cfg(target_arch = "x86_64")]
        impl Coordinates<$number> for Register<$vector> {
            #[inline(always)]
            fn load(self, from: &[$number; 4]) -> Self {
                self.of(cast(*from))
            }

            #[inline(always)]
            fn store(self, to: &mut [$number; 4]) {
                *to = cast(self.values);
            }

            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                self.of(self.simd.$add(self.values, other.values))
            }

            #[inline(always)]
            fn minus(self, other: Self) -> Self {
                self.of(self.simd.$sub(self.values, other.values))
            }

            #[inline(always)]
            fn times(self, other: Self) -> Self {
                self.of(self.simd.$mul(self.values, other.values))
            }

            #[inline(always)]
            fn scaled(self, factor: $number) -> Self {
                self.of(self.simd.$mul(self.values, self.simd.$splat(factor)))
            }

            #[inline(always)]
            fn plus_scaled(self, factor: $number, other: Self) -> Self {
                self.of(self.simd.$mul_add(self.simd.$splat(factor), other.values, self.values))
            }

            #[inline(always)]
            fn plus_products(self, a: Self, b: Self) -> Self {
                self.of(self.simd.$mul_add(a.values, b.values, self.values))
            }

            #[inline(always)]
            fn turned(self) -> Self {
                let values: $machine = cast(self.values);
                // Two bits name the source of each place, the lowest first: 1, 2, 0, and 3 stays where it is.
                self.of(cast(self.simd.$set.$turn::<0b11_00_10_01>(values)))
            }

            #[inline(always)]
            fn difference_of_products(self, b: Self, c: Self, d: Self) -> Self {
                // One of the two products is not rounded. The difference of equal products is then their rounding
                // error, not zero.
                self.of(self.simd.$mul_sub(self.values, b.values, self.simd.$mul(c.values, d.values)))
            }

            #[inline(always)]
            fn dot(self, other: Self) -> $number {
                let products: [$number; 4] = cast(self.simd.$mul(self.values, other.values));
                // A vector has three coordinates: the fourth number only fills the register.
                products[0] + products[1] + products[2]
            }

            $($own)*
        }
    };
}

registers!(
    f64,
    OnF64,
    f64x4,
    splat_f64x4,
    add_f64x4,
    sub_f64x4,
    mul_f64x4,
    mul_add_f64x4,
    mul_sub_f64x4,
    avx2._mm256_permute4x64_pd(__m256d),
    {
        #[inline(always)]
        fn load_single(self, from: &[f32; 4]) -> Self {
            self.of(cast(self.simd.avx._mm256_cvtps_pd(cast(*from))))
        }

        #[inline(always)]
        fn store_single(self, to: &mut [f32; 4]) {
            *to = cast(self.simd.avx._mm256_cvtpd_ps(cast(self.values)));
        }

        #[inline(always)]
        fn sums([a, b, c, d]: [Self; 4]) -> Self {
            let avx = a.simd.avx;
            let pairs = |a: Self, b: Self| avx._mm256_hadd_pd(cast(a.values), cast(b.values));
            let (ab, cd) = (pairs(a, b), pairs(c, d));
            let lower = avx._mm256_permute2f128_pd::<0x20>(ab, cd);
            let upper = avx._mm256_permute2f128_pd::<0x31>(ab, cd);
            a.of(a.simd.add_f64x4(cast(lower), cast(upper)))
        }
    }
);
registers!(
    f32,
    OnF32,
    f32x4,
    splat_f32x4,
    add_f32x4,
    sub_f32x4,
    mul_f32x4,
    mul_add_f32x4,
    mul_sub_f32x4,
    avx._mm_permute_ps(__m128),
    {
        #[inline(always)]
        fn load_single(self, from: &[f32; 4]) -> Self {
            self.load(from)
        }

        #[inline(always)]
        fn store_single(self, to: &mut [f32; 4]) {
            self.store(to);
        }

        #[inline(always)]
        fn sums([a, b, c, d]: [Self; 4]) -> Self {
            let sum = |vector: Self| cast::<_, [f32; 4]>(vector.values).iter().sum();
            a.of(cast::<[f32; 4], _>([sum(a), sum(b), sum(c), sum(d)]))
        }
    }
);
