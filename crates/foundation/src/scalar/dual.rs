//! Numbers with their derivatives: what a kernel computes with them, it differentiates.
//!
//! Theory: page *Gradients of spring constants* of the book.

use super::{Real, Scalar};
use std::ops::{Add, Div, Mul, Sub};

/// `a + Σ_i b_i ε_i` with `ε_i ε_j = 0`: a value and its derivatives in N directions (Clifford 1873).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// The derivatives.
    pub slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A number that does not change.
    pub fn steady(value: f64) -> Dual<N> {
        Dual { value, slopes: [0.0; N] }
    }

    /// The value, and `own` times these slopes plus `other` times those of another number.
    #[inline(always)]
    fn with(value: f64, a: &Dual<N>, own: f64, b: &Dual<N>, other: f64) -> Dual<N> {
        let mut slopes = [0.0; N];
        for i in 0..N {
            slopes[i] = own * a.slopes[i] + other * b.slopes[i];
        }
        Dual { value, slopes }
    }
}

impl<const N: usize> Add<&Dual<N>> for Dual<N> {
    type Output = Dual<N>;

    #[inline(always)]
    fn add(self, y: &Dual<N>) -> Dual<N> {
        Dual::with(self.value + y.value, &self, 1.0, y, 1.0)
    }
}

impl<const N: usize> Sub<&Dual<N>> for Dual<N> {
    type Output = Dual<N>;

    #[inline(always)]
    fn sub(self, y: &Dual<N>) -> Dual<N> {
        Dual::with(self.value - y.value, &self, 1.0, y, -1.0)
    }
}

impl<const N: usize> Mul<&Dual<N>> for Dual<N> {
    type Output = Dual<N>;

    #[inline(always)]
    fn mul(self, y: &Dual<N>) -> Dual<N> {
        Dual::with(self.value * y.value, &self, y.value, y, self.value)
    }
}

impl<const N: usize> Div<&Dual<N>> for Dual<N> {
    type Output = Dual<N>;

    #[inline(always)]
    fn div(self, y: &Dual<N>) -> Dual<N> {
        let value = self.value / y.value;
        Dual::with(value, &self, 1.0 / y.value, y, -value / y.value)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    type Constant = f64;

    #[inline(always)]
    fn exact(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn epsilon() -> f64 {
        f64::epsilon()
    }

    #[inline(always)]
    fn constant(&self, c: &f64) -> Dual<N> {
        Dual::steady(*c)
    }

    #[inline(always)]
    fn scaled(self, c: &f64) -> Dual<N> {
        Dual::with(self.value * c, &self, *c, &self, 0.0)
    }

    #[inline(always)]
    fn plus_product(self, a: &Dual<N>, b: &Dual<N>) -> Dual<N> {
        self + &(*a * b)
    }

    #[inline(always)]
    fn minus_product(self, a: &Dual<N>, b: &Dual<N>) -> Dual<N> {
        self - &(*a * b)
    }

    #[inline(always)]
    fn exceeds(&self, other: &Dual<N>) -> bool {
        self.value > other.value
    }
}

impl<const N: usize> Real for Dual<N> {
    #[inline(always)]
    fn sqrt(self) -> Dual<N> {
        let root = self.value.sqrt();
        Dual::with(root, &self, 0.5 / root, &self, 0.0)
    }

    #[inline(always)]
    fn choose(&self, yes: &Dual<N>, no: &Dual<N>) -> Dual<N> {
        if self.value > 0.0 { *yes } else { *no }
    }

    #[inline(always)]
    fn rounded(&self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn vanished(&self) -> Dual<N> {
        Dual { value: 0.0, slopes: self.slopes }
    }
}
