//! Numbers with their derivatives: what a kernel computes with them, it differentiates.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::{Real, Scalar};
use std::ops::{Add, Div, Mul, Sub};

/// `a + Σ_i b_i ε_i` with `ε_i ε_j = 0`: a value and its derivatives in N directions (Clifford 1873).
///
/// The values may be lanes, one element per lane, or dual numbers again, whose derivatives are second ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const N: usize, T = f64> {
    /// The value.
    pub value: T,
    /// The derivatives.
    pub slopes: [T; N],
}

impl<const N: usize> Dual<N> {
    /// A number that does not change.
    pub fn steady(value: f64) -> Dual<N> {
        Dual { value, slopes: [0.0; N] }
    }
}

impl<const N: usize, T: Scalar> Dual<N, T> {
    /// The value, and `own` times these slopes plus `other` times those of another number.
    #[inline(always)]
    fn with(value: T, a: &Dual<N, T>, own: &T, b: &Dual<N, T>, other: &T) -> Dual<N, T> {
        let mut slopes = a.slopes.clone();
        for i in 0..N {
            slopes[i] = (a.slopes[i].clone() * own).plus_product(&b.slopes[i], other);
        }
        Dual { value, slopes }
    }

    /// The value with zero slopes.
    #[inline(always)]
    fn constant_like(&self, value: T) -> Dual<N, T> {
        let slopes = value.zero().repeated();
        Dual { value, slopes }
    }
}

impl<const N: usize, T: Scalar> Add<&Dual<N, T>> for Dual<N, T> {
    type Output = Dual<N, T>;

    #[inline(always)]
    fn add(mut self, y: &Dual<N, T>) -> Dual<N, T> {
        for i in 0..N {
            self.slopes[i] = self.slopes[i].clone() + &y.slopes[i];
        }
        Dual { value: self.value + &y.value, slopes: self.slopes }
    }
}

impl<const N: usize, T: Scalar> Sub<&Dual<N, T>> for Dual<N, T> {
    type Output = Dual<N, T>;

    #[inline(always)]
    fn sub(mut self, y: &Dual<N, T>) -> Dual<N, T> {
        for i in 0..N {
            self.slopes[i] = self.slopes[i].clone() - &y.slopes[i];
        }
        Dual { value: self.value - &y.value, slopes: self.slopes }
    }
}

impl<const N: usize, T: Scalar> Mul<&Dual<N, T>> for Dual<N, T> {
    type Output = Dual<N, T>;

    #[inline(always)]
    fn mul(self, y: &Dual<N, T>) -> Dual<N, T> {
        Dual::with(self.value.clone() * &y.value, &self, &y.value, y, &self.value)
    }
}

impl<const N: usize, T: Scalar> Div<&Dual<N, T>> for Dual<N, T> {
    type Output = Dual<N, T>;

    #[inline(always)]
    fn div(self, y: &Dual<N, T>) -> Dual<N, T> {
        let value = self.value.clone() / &y.value;
        let own = y.value.one() / &y.value;
        // `−a/b²` is `−(a/b)/b`: the quotient is there already, and the square cannot overflow.
        let other = value.zero() - &(value.clone() * &own);
        Dual::with(value, &self, &own, y, &other)
    }
}

impl<const N: usize, T: Real> Scalar for Dual<N, T> {
    type Constant = f64;

    /// Derivatives in the moduli are those in λ and μ.
    const ANISOTROPIC: bool = false;

    /// In a function that is compiled for the instructions of the values.
    #[inline(always)]
    fn vectorize<R>(&self, work: impl FnOnce() -> R) -> R {
        self.value.vectorize(work)
    }

    #[inline(always)]
    fn exact(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn epsilon() -> f64 {
        T::epsilon()
    }

    #[inline(always)]
    fn delicate() -> f64 {
        T::delicate()
    }

    #[inline(always)]
    fn constant(&self, c: &f64) -> Dual<N, T> {
        self.constant_like(self.value.constant(c))
    }

    #[inline(always)]
    fn scaled(mut self, c: &f64) -> Dual<N, T> {
        for i in 0..N {
            self.slopes[i] = self.slopes[i].clone().scaled(c);
        }
        Dual { value: self.value.scaled(c), slopes: self.slopes }
    }

    #[inline(always)]
    fn plus_product(self, a: &Dual<N, T>, b: &Dual<N, T>) -> Dual<N, T> {
        let mut slopes = self.slopes;
        for i in 0..N {
            slopes[i] = slopes[i].clone().plus_product(&a.slopes[i], &b.value).plus_product(&b.slopes[i], &a.value);
        }
        Dual { value: self.value.plus_product(&a.value, &b.value), slopes }
    }

    #[inline(always)]
    fn minus_product(self, a: &Dual<N, T>, b: &Dual<N, T>) -> Dual<N, T> {
        let mut slopes = self.slopes;
        for i in 0..N {
            slopes[i] = slopes[i].clone().minus_product(&a.slopes[i], &b.value).minus_product(&b.slopes[i], &a.value);
        }
        Dual { value: self.value.minus_product(&a.value, &b.value), slopes }
    }

    #[inline(always)]
    fn exceeds(&self, other: &Dual<N, T>) -> bool {
        // Branches follow the values alone, so that slopes take the same way as the numbers whose slopes they are.
        self.value.exceeds(&other.value)
    }
}

impl<const N: usize, T: Real> Real for Dual<N, T> {
    #[inline(always)]
    fn sqrt(self) -> Dual<N, T> {
        let root = self.value.clone().sqrt();
        let half = root.constant(&0.5) / &root;
        // The rule for two arguments serves a function of one, whose second slope is zero.
        let zero = root.zero();
        Dual::with(root, &self, &half, &self, &zero)
    }

    #[inline(always)]
    fn choose(&self, yes: &Dual<N, T>, no: &Dual<N, T>) -> Dual<N, T> {
        let mut slopes = yes.slopes.clone();
        for i in 0..N {
            // The value decides for the slopes as well: in lanes each element follows the number that was chosen for it.
            slopes[i] = self.value.choose(&yes.slopes[i], &no.slopes[i]);
        }
        Dual { value: self.value.choose(&yes.value, &no.value), slopes }
    }

    #[inline(always)]
    fn rounded(&self) -> f64 {
        self.value.rounded()
    }

    #[inline(always)]
    fn vanished(&self) -> Dual<N, T> {
        Dual { value: self.value.vanished(), slopes: self.slopes.clone() }
    }
}
