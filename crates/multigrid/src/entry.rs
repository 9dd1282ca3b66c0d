//! Entries of vectors: of one vector, or of several side by side, so that a matrix is read once for all of them.

use std::array::from_fn;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Sub, SubAssign};

/// One number of a vector, or that of each of several vectors.
pub(crate) trait Entry:
    Copy
    + Debug
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
{
    /// Vectors side by side.
    const COUNT: usize;
    const ZERO: Self;

    /// The number of each vector.
    fn of_each(number: impl FnMut(usize) -> f64) -> Self;

    /// The number of one vector.
    fn lane(&self, lane: usize) -> f64;

    /// `Σ_j A_j x_j` over the blocks of a row.
    fn row_product<const R: usize, const C: usize>(
        blocks: &[[[f64; C]; R]],
        columns: &[u32],
        x: &[[Self; C]],
    ) -> [Self; R];
}

impl Entry for f64 {
    const COUNT: usize = 1;
    const ZERO: f64 = 0.0;

    #[inline(always)]
    fn of_each(mut number: impl FnMut(usize) -> f64) -> f64 {
        number(0)
    }

    #[inline(always)]
    fn lane(&self, _: usize) -> f64 {
        *self
    }

    #[inline(always)]
    fn row_product<const R: usize, const C: usize>(
        blocks: &[[[f64; C]; R]],
        columns: &[u32],
        x: &[[f64; C]],
    ) -> [f64; R] {
        // A sum for each entry of a block: no addition waits for another.
        let mut sums = [[0.0; C]; R];
        for (block, &column) in blocks.iter().zip(columns) {
            let x = &x[column as usize];
            for i in 0..R {
                for j in 0..C {
                    sums[i][j] += block[i][j] * x[j];
                }
            }
        }
        sums.map(|row| row.iter().sum())
    }
}

/// Right-hand sides that are solved side by side: numbers of one register of 512 bits.
pub const WIDTH: usize = 8;

/// The numbers of [`WIDTH`] vectors.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Lanes([f64; WIDTH]);

impl Entry for Lanes {
    const COUNT: usize = WIDTH;
    const ZERO: Lanes = Lanes([0.0; WIDTH]);

    #[inline(always)]
    fn of_each(number: impl FnMut(usize) -> f64) -> Lanes {
        Lanes(from_fn(number))
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.0[lane]
    }

    #[inline(always)]
    fn row_product<const R: usize, const C: usize>(
        blocks: &[[[f64; C]; R]],
        columns: &[u32],
        x: &[[Lanes; C]],
    ) -> [Lanes; R] {
        let mut sums = [Lanes::ZERO; R];
        for (block, &column) in blocks.iter().zip(columns) {
            let x = &x[column as usize];
            // A number of x is loaded once for all rows of the block.
            for j in 0..C {
                for i in 0..R {
                    sums[i] += x[j] * block[i][j];
                }
            }
        }
        sums
    }
}

/// Defines an operator lane by lane, with the lanes of other numbers or with one number for all.
macro_rules! operator {
    ($trait:ident<$other:ty>, $method:ident, |$lanes:ident, $by:ident| $work:expr) => {
        impl $trait<$other> for Lanes {
            type Output = Lanes;

            #[inline(always)]
            fn $method(self, $by: $other) -> Lanes {
                let $lanes = self.0;
                Lanes($work)
            }
        }
    };
}

operator!(Add<Lanes>, add, |x, y| from_fn(|l| x[l] + y.0[l]));
operator!(Sub<Lanes>, sub, |x, y| from_fn(|l| x[l] - y.0[l]));
operator!(Mul<Lanes>, mul, |x, y| from_fn(|l| x[l] * y.0[l]));
operator!(Mul<f64>, mul, |x, factor| x.map(|x| x * factor));
operator!(Div<f64>, div, |x, divisor| x.map(|x| x / divisor));

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Lanes) {
        *self = *self + other;
    }
}

impl SubAssign for Lanes {
    #[inline(always)]
    fn sub_assign(&mut self, other: Lanes) {
        *self = *self - other;
    }
}

/// One of the vectors.
pub(crate) fn vector<T: Entry, const N: usize>(x: &[[T; N]], lane: usize) -> Vec<[f64; N]> {
    x.iter().map(|x| x.each_ref().map(|x| x.lane(lane))).collect()
}

/// Vectors of numbers one after another, side by side; zero in lanes without one.
pub(crate) fn beside<T: Entry, const N: usize>(vectors: &[&[f64]]) -> Vec<[T; N]> {
    let rows = vectors.first().map_or(0, |first| first.len() / N);
    let entry = |at: usize| T::of_each(|lane| vectors.get(lane).map_or(0.0, |vector| vector[at]));
    (0..rows).map(|row| from_fn(|k| entry(row * N + k))).collect()
}
