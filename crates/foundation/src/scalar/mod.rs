//! The numbers that kernels compute with: the traits [`Scalar`] (+ − × ÷ and one comparison) and [`Real`] (roots and
//! choices).
//!
//! One source of each kernel serves `f64`, [`Lanes`] (one element per lane), `f32` and [`DoubleDouble`] for studies of
//! rounding, [`Dual`] numbers, which carry derivatives, exact rationals, and the rational functions of [`symbolic`](crate::symbolic).
//!
//! Theory: page *Precision* of the book.

mod coordinates;
mod dimension;
mod double_double;
mod dual;
mod groups;
mod lanes;
mod norm;
mod registers;
mod sum;
mod vectorized;

#[doc(hidden)]
pub use crate::{of_dimension, vectorized};
pub use coordinates::{Coordinate, Coordinates, CoordinatesWork, with_coordinates};
pub use double_double::DoubleDouble;
pub use dual::Dual;
pub use groups::{Group, GroupWork};
pub use lanes::{Lanes, Packed, PackedWork, at_most_four, dispatched, widest};
pub use norm::{distance, norm, scaled_norm};
pub use sum::Sum;

use num_rational::BigRational;
use num_traits::{One, Zero};
use std::ops::{Add, Div, Mul, Sub};

/// A number of a kernel: exact or rounded, single or one per lane.
pub trait Scalar:
    Clone
    + for<'a> Add<&'a Self, Output = Self>
    + for<'a> Sub<&'a Self, Output = Self>
    + for<'a> Mul<&'a Self, Output = Self>
    + for<'a> Div<&'a Self, Output = Self>
{
    /// A number that is the same for all elements: an entry of a tabulation, a modulus.
    type Constant: Clone + Zero + One;

    /// Whether a kernel is compiled once more for each of the common orders of its equations, so that its loops
    /// unroll. This is worth its compile time for lanes only.
    const UNROLLED: bool = false;

    /// Whether kernels are compiled for anisotropic materials as well. Numbers that only isotropic materials use are compiled without that code,
    /// which saves time.
    const ANISOTROPIC: bool = true;

    /// Runs `work` in a function of its own that is compiled for the machine's instructions. The function is never
    /// inlined into its caller, so that the compiler optimises each kernel once and separately.
    fn vectorize<R>(&self, work: impl FnOnce() -> R) -> R {
        outlined(work)
    }

    /// An array of N copies.
    #[inline(always)]
    fn repeated<const N: usize>(&self) -> [Self; N] {
        std::array::from_fn(|_| self.clone())
    }

    /// A rows of B copies each.
    #[inline(always)]
    fn repeated_rows<const A: usize, const B: usize>(&self) -> [[Self; B]; A] {
        std::array::from_fn(|_| self.repeated())
    }

    /// `value`, exactly if the type can represent it.
    fn exact(value: f64) -> Self::Constant;

    /// The largest relative error of one operation.
    fn epsilon() -> f64;

    /// The largest relative error of the input data, coordinates and tabulations. Differences below it count as zero.
    fn given() -> f64 {
        Self::epsilon()
    }

    /// A Jacobian determinant below this share of its largest possible value, the product of the lengths of its columns
    /// (Hadamard's bound), counts as zero: its rounding error is of this size. Lanes use a larger threshold and leave
    /// the cells below it to numbers with more digits.
    fn delicate() -> f64 {
        9.0 * Self::given()
    }

    /// `c` as a number of the same kind as `self`.
    fn constant(&self, c: &Self::Constant) -> Self;

    /// `self · c`.
    fn scaled(self, c: &Self::Constant) -> Self;

    /// `self + a b`; rounded only once where this costs no more.
    fn plus_product(self, a: &Self, b: &Self) -> Self;

    /// `self − a b`; rounded only once where this costs no more.
    fn minus_product(self, a: &Self, b: &Self) -> Self;

    /// Whether `self > other` in every lane; false if a lane is NaN.
    fn exceeds(&self, other: &Self) -> bool;

    /// Zero, of the same kind as `self`.
    #[inline(always)]
    fn zero(&self) -> Self {
        self.constant(&Self::Constant::zero())
    }

    /// One, of the same kind as `self`.
    #[inline(always)]
    fn one(&self) -> Self {
        self.constant(&Self::Constant::one())
    }

    /// `self²`.
    #[inline(always)]
    fn squared(self) -> Self {
        let same = self.clone();
        self * &same
    }
}

#[inline(never)]
fn outlined<R>(work: impl FnOnce() -> R) -> R {
    work()
}

// Vectors of a known dimension follow. They use loops instead of closures: code that is not inlined into the function
// that is compiled for the machine's instructions does not use these instructions.

/// The zero vector of D components.
#[inline(always)]
pub fn zeros<T: Scalar, const D: usize>(zero: &T) -> [T; D] {
    zero.repeated()
}

/// What the solvers need besides: roots and choices, in each lane separately.
pub trait Real: Scalar<Constant = f64> {
    /// The square root; NaN below zero.
    fn sqrt(self) -> Self;

    /// `yes` if `self > 0`, otherwise `no`; also `no` if `self` is NaN.
    fn choose(&self, yes: &Self, no: &Self) -> Self;

    /// The nearest `f64`; that of the first lane.
    fn rounded(&self) -> f64;

    /// Runs `work` with groups of such numbers where the machine computes a group sooner than its numbers one by one, and hands it back elsewhere.
    fn grouped<W: GroupWork<Self>>(&self, work: W) -> Result<W::Output, W> {
        Err(work)
    }

    /// Zero in place of a value that is only rounding. Derivatives stay: they are not zero where the value is.
    #[inline(always)]
    fn vanished(&self) -> Self {
        self.zero()
    }

    /// The lesser of the two numbers.
    #[inline(always)]
    fn least(&self, other: &Self) -> Self {
        (other.clone() - self).choose(self, other)
    }

    /// The greater of the two numbers.
    #[inline(always)]
    fn greatest(&self, other: &Self) -> Self {
        (self.clone() - other).choose(self, other)
    }

    /// `−self`.
    #[inline(always)]
    fn negated(&self) -> Self {
        self.zero() - self
    }

    /// `|self|`.
    #[inline(always)]
    fn magnitude(&self) -> Self {
        self.choose(self, &self.negated())
    }
}

impl Real for f64 {
    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn rounded(&self) -> f64 {
        *self
    }

    #[inline(always)]
    fn choose(&self, yes: &f64, no: &f64) -> f64 {
        // NaN is not above zero and takes the second choice, as the comparison of registers does.
        if *self > 0.0 { *yes } else { *no }
    }
}

/// The scalar product `Σ_k a_k b_k`.
#[inline(always)]
pub fn dot<T: Scalar, const D: usize>(a: &[T; D], b: &[T; D]) -> T {
    let mut sum = a[0].clone() * &b[0];
    for k in 1..D {
        sum = sum.plus_product(&a[k], &b[k]);
    }
    sum
}

/// `a − b`.
#[inline(always)]
pub fn difference<T: Scalar, const D: usize>(a: &[T; D], b: &[T; D]) -> [T; D] {
    let mut result = a.clone();
    for k in 0..D {
        result[k] = a[k].clone() - &b[k];
    }
    result
}

/// `a + c b`.
#[inline(always)]
pub fn plus_multiple<T: Scalar, const D: usize>(a: &[T; D], c: &T, b: &[T; D]) -> [T; D] {
    let mut result = a.clone();
    for k in 0..D {
        result[k] = a[k].clone().plus_product(c, &b[k]);
    }
    result
}

/// `c A`, for a matrix of shape `[D][D]`.
#[inline(always)]
pub fn multiple<T: Scalar, const D: usize>(c: &T, a: &[[T; D]; D]) -> [[T; D]; D] {
    let mut result = a.clone();
    for k in 0..D {
        for l in 0..D {
            result[k][l] = a[k][l].clone() * c;
        }
    }
    result
}

/// `A b`, for a matrix of shape `[D][D]`.
#[inline(always)]
pub fn product<T: Scalar, const D: usize>(a: &[[T; D]; D], b: &[T; D]) -> [T; D] {
    let mut result = b.clone();
    for k in 0..D {
        result[k] = dot(&a[k], b);
    }
    result
}

/// The adjugate and the determinant of `A`, so that `A⁻¹ = adj(A)/det A`; D is 1, 2 or 3.
#[inline(always)]
pub fn adjugate<T: Scalar, const D: usize>(a: &[[T; D]; D]) -> ([[T; D]; D], T) {
    let zero = a[0][0].zero();
    let mut adjugate: [[T; D]; D] = zero.repeated_rows();
    match D {
        1 => adjugate[0][0] = zero.one(),
        2 => {
            for l in 0..2 {
                adjugate[l][l] = a[1 - l][1 - l].clone();
                adjugate[l][1 - l] = zero.clone() - &a[l][1 - l];
            }
        }
        _ => {
            for l in 0..3 {
                for k in 0..3 {
                    let (p, q, r, s) = ((k + 1) % 3, (k + 2) % 3, (l + 1) % 3, (l + 2) % 3);
                    adjugate[l][k] = (a[p][r].clone() * &a[q][s]).minus_product(&a[p][s], &a[q][r]);
                }
            }
        }
    }
    // The first row times its cofactors, which the adjugate has already.
    let mut determinant = a[0][0].clone() * &adjugate[0][0];
    for l in 1..D {
        determinant = determinant.plus_product(&a[0][l], &adjugate[l][0]);
    }
    (adjugate, determinant)
}

macro_rules! plain {
    ($type:ty, $exact:expr, $epsilon:expr) => {
        impl Scalar for $type {
            type Constant = $type;

            #[inline(always)]
            fn exact(value: f64) -> $type {
                $exact(value)
            }

            #[inline(always)]
            fn epsilon() -> f64 {
                $epsilon
            }

            #[inline(always)]
            fn constant(&self, c: &$type) -> $type {
                c.clone()
            }

            #[inline(always)]
            fn scaled(self, c: &$type) -> $type {
                self * c
            }

            #[inline(always)]
            fn plus_product(self, a: &$type, b: &$type) -> $type {
                self + a * b
            }

            #[inline(always)]
            fn minus_product(self, a: &$type, b: &$type) -> $type {
                self - a * b
            }

            #[inline(always)]
            fn exceeds(&self, other: &$type) -> bool {
                self > other
            }
        }
    };
}

plain!(f64, |value| value, f64::EPSILON / 2.0);
// Exact numbers have no rounding error.
plain!(BigRational, |value| BigRational::from_float(value).expect("constants are finite"), 0.0);
