//! What the kernels of the least-squares fits need of a number: + − × ÷ and one comparison.
//!
//! The same source runs on `f64`, on [`Lanes`] of them (one element per lane), on `f32` and on pairs of `f64` for studies of
//! rounding, and on exact rationals.

mod coordinates;
mod double_double;
mod lanes;
mod norm;
mod sum;

pub use coordinates::{Coordinates, CoordinatesWork, with_coordinates};
pub use double_double::DoubleDouble;
pub use lanes::{Lanes, Packed, PackedWork, widest};
pub use norm::{distance, norm, scaled_norm};
pub use sum::Sum;

use num_rational::BigRational;
use num_traits::{One, Zero};
use std::ops::{Add, Div, Mul, Sub};

pub trait Scalar:
    Clone
    + for<'a> Add<&'a Self, Output = Self>
    + for<'a> Sub<&'a Self, Output = Self>
    + for<'a> Mul<&'a Self, Output = Self>
    + for<'a> Div<&'a Self, Output = Self>
{
    /// A number that is the same for all elements: entries of a tabulation, moduli.
    type Constant: Clone + Zero + One;

    /// Whether a kernel is worth a copy for each of the common numbers of nodes and springs, in which its loops unroll.
    const UNROLLED: bool = false;

    /// Does the work in a function of its own, compiled for the machine's instructions. It is never inlined into its caller, so that
    /// the compiler optimises each kernel once and by itself.
    fn vectorize<R>(&self, work: impl FnOnce() -> R) -> R {
        outlined(work)
    }

    /// N copies.
    #[inline(always)]
    fn repeated<const N: usize>(&self) -> [Self; N] {
        std::array::from_fn(|_| self.clone())
    }

    /// A rows of B copies.
    #[inline(always)]
    fn repeated_rows<const A: usize, const B: usize>(&self) -> [[Self; B]; A] {
        std::array::from_fn(|_| self.repeated())
    }

    /// `value` exactly, where the type can.
    fn exact(value: f64) -> Self::Constant;

    /// Largest relative error of one operation.
    fn epsilon() -> f64;

    /// Largest relative error of what is given, coordinates and tabulations; what lies below is not told from zero.
    fn given() -> f64 {
        Self::epsilon()
    }

    /// Below this share of the largest that its columns' lengths allow a Jacobian determinant counts as zero: of as many digits its
    /// own rounding takes. Lanes leave more to numbers that have them.
    fn delicate() -> f64 {
        9.0 * Self::given()
    }

    /// `c` as a number of the kind of `self`.
    fn constant(&self, c: &Self::Constant) -> Self;

    /// `self · c`.
    fn scaled(self, c: &Self::Constant) -> Self;

    /// `self + a b`, rounded once where that is as fast.
    fn plus_product(self, a: &Self, b: &Self) -> Self;

    /// `self − a b`, rounded once where that is as fast.
    fn minus_product(self, a: &Self, b: &Self) -> Self;

    /// Whether `self > other`, in every lane; false where one is not a number.
    fn exceeds(&self, other: &Self) -> bool;

    #[inline(always)]
    fn zero(&self) -> Self {
        self.constant(&Self::Constant::zero())
    }

    #[inline(always)]
    fn one(&self) -> Self {
        self.constant(&Self::Constant::one())
    }

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

// Vectors of a known dimension. Loops instead of closures: what is not inlined into the function that the processor's
// instructions were chosen for does not use them.

#[inline(always)]
pub fn zeros<T: Scalar, const D: usize>(zero: &T) -> [T; D] {
    zero.repeated()
}

/// What the solvers need besides: roots and choices, lane by lane.
pub trait Real: Scalar<Constant = f64> {
    fn sqrt(self) -> Self;

    /// `yes` where `self > 0`, otherwise `no`; also where `self` is not a number.
    fn choose(&self, yes: &Self, no: &Self) -> Self;

    /// The nearest `f64`, of the first lane.
    fn rounded(&self) -> f64;

    #[inline(always)]
    fn least(&self, other: &Self) -> Self {
        (other.clone() - self).choose(self, other)
    }

    #[inline(always)]
    fn greatest(&self, other: &Self) -> Self {
        (self.clone() - other).choose(self, other)
    }

    #[inline(always)]
    fn negated(&self) -> Self {
        self.zero() - self
    }

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
        if *self > 0.0 { *yes } else { *no }
    }
}

/// `Σ_k a_k b_k`.
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

/// `c A`.
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

/// `A b`.
#[inline(always)]
pub fn product<T: Scalar, const D: usize>(a: &[[T; D]; D], b: &[T; D]) -> [T; D] {
    let mut result = b.clone();
    for k in 0..D {
        result[k] = dot(&a[k], b);
    }
    result
}

/// `adj(A)` and `det A`, so that `A⁻¹ = adj(A)/det A`.
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
plain!(BigRational, |value| BigRational::from_float(value).expect("constants are finite"), 0.0);
