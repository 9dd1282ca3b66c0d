//! The three coordinates of a point in one register, for loops over springs and cells that share points.
//!
//! Such loops read and write points at scattered places. With one cell per SIMD lane, every number would be gathered
//! and scattered one by one; with one point per register it is loaded and stored at once.

use num_traits::Float;
use std::fmt::Debug;

/// The numbers that coordinates have: `f64`, or `f32` with half the digits in half the memory.
pub trait Coordinate: Float + Default + Debug + Send + Sync + 'static {
    /// Whether positions are measured from a point of the body before they are rounded, because the digits that they lose far from zero
    /// matter.
    const IS_SHORT: bool;

    /// The nearest number to x.
    fn of(x: f64) -> Self;

    /// Converts the number to one with the digits of an `f64`.
    fn wide(self) -> f64;

    /// Runs `work` with one register per point if the machine has AVX2, and with arrays otherwise.
    fn with_coordinates<W: CoordinatesWork<Self>>(work: W) -> W::Output;
}

/// A vector of three coordinates and one unused entry. Where a method makes a new vector, `self` only selects the kind
/// of register.
pub trait Coordinates<N: Coordinate = f64>: Copy {
    /// Reads four numbers.
    fn load(self, from: &[N; 4]) -> Self;

    /// Writes four numbers.
    fn store(self, to: &mut [N; 4]);

    /// Reads four numbers of single precision.
    fn load_single(self, from: &[f32; 4]) -> Self;

    /// Writes four numbers, rounded to single precision.
    fn store_single(self, to: &mut [f32; 4]);

    /// `self + other`.
    fn plus(self, other: Self) -> Self;

    /// `self − other`.
    fn minus(self, other: Self) -> Self;

    /// The product of each coordinate with that of the other.
    fn times(self, other: Self) -> Self;

    /// `factor · self`.
    fn scaled(self, factor: N) -> Self;

    /// `self + factor · other`.
    fn plus_scaled(self, factor: N, other: Self) -> Self;

    /// `self + a b` for each coordinate.
    fn plus_products(self, a: Self, b: Self) -> Self;

    /// The cyclic permutation `(y, z, x)` of `(x, y, z)`, from which cross products are built.
    fn turned(self) -> Self;

    /// `a b − c d` for each coordinate, with `self` as `a`.
    fn difference_of_products(self, b: Self, c: Self, d: Self) -> Self;

    /// The sum of all four entries of each vector.
    fn sums(vectors: [Self; 4]) -> Self;

    /// The scalar product `x x' + y y' + z z'`.
    fn dot(self, other: Self) -> N;
}

/// A computation that is written once for every kind of register.
pub trait CoordinatesWork<N: Coordinate = f64> {
    /// What the computation returns.
    type Output;

    /// Runs the computation. `zero` selects the kind of register.
    fn run<C: Coordinates<N>>(self, zero: C) -> Self::Output;
}

/// Runs `work` with one register per point if the machine has AVX2, and with arrays otherwise.
pub fn with_coordinates<N: Coordinate, W: CoordinatesWork<N>>(work: W) -> W::Output {
    N::with_coordinates(work)
}

/// For machines without such registers.
impl<N: Coordinate> Coordinates<N> for [N; 4] {
    #[inline(always)]
    fn load(self, from: &[N; 4]) -> [N; 4] {
        *from
    }

    #[inline(always)]
    fn store(self, to: &mut [N; 4]) {
        *to = self;
    }

    #[inline(always)]
    fn load_single(self, from: &[f32; 4]) -> [N; 4] {
        from.map(|x| N::of(f64::from(x)))
    }

    #[inline(always)]
    fn store_single(self, to: &mut [f32; 4]) {
        *to = self.map(|x| x.wide() as f32);
    }

    #[inline(always)]
    fn plus(self, other: [N; 4]) -> [N; 4] {
        std::array::from_fn(|k| self[k] + other[k])
    }

    #[inline(always)]
    fn minus(self, other: [N; 4]) -> [N; 4] {
        std::array::from_fn(|k| self[k] - other[k])
    }

    #[inline(always)]
    fn times(self, other: [N; 4]) -> [N; 4] {
        std::array::from_fn(|k| self[k] * other[k])
    }

    #[inline(always)]
    fn scaled(self, factor: N) -> [N; 4] {
        self.map(|x| x * factor)
    }

    #[inline(always)]
    fn plus_scaled(self, factor: N, other: [N; 4]) -> [N; 4] {
        std::array::from_fn(|k| self[k] + factor * other[k])
    }

    #[inline(always)]
    fn plus_products(self, a: [N; 4], b: [N; 4]) -> [N; 4] {
        std::array::from_fn(|k| self[k] + a[k] * b[k])
    }

    #[inline(always)]
    fn turned(self) -> [N; 4] {
        [self[1], self[2], self[0], self[3]]
    }

    #[inline(always)]
    fn difference_of_products(self, b: [N; 4], c: [N; 4], d: [N; 4]) -> [N; 4] {
        std::array::from_fn(|k| self[k] * b[k] - c[k] * d[k])
    }

    #[inline(always)]
    fn sums(vectors: [[N; 4]; 4]) -> [N; 4] {
        vectors.map(|[a, b, c, d]| a + b + c + d)
    }

    #[inline(always)]
    fn dot(self, other: [N; 4]) -> N {
        self[0] * other[0] + self[1] * other[1] + self[2] * other[2]
    }
}
