//! Cube roots of several numbers at a time.

use crate::scalar::Packed;

/// Steps of the fourth order from 3 % to rounding.
// The start errs by 3.4 % at most, which the first step takes to 1.7e-5 and the second to rounding.
const REFINEMENTS: usize = 2;

/// `j^(−1/3)` of numbers above zero: a third of the exponent, then `y ← y (1 + r/3 + 2 r²/9 + 14 r³/81)` with `r = 1 − j y³`, the beginning of the
/// series of `(1 − r)^(−1/3)`.
#[inline(always)]
pub fn inverse_cube_root<T: Packed>(zero: &T, j: &T) -> T {
    let mut y = zero.clone();
    for (y, j) in y.as_mut_slice().iter_mut().zip(j.as_slice()) {
        // The upper half of the bits, divided by three; the constant is that of 1, less what its mantissa errs on the mean.
        let third = ((j.to_bits() >> 32) * 0x5555_5556) >> 32;
        *y = f64::from_bits(0x553e_f0ff_u64.wrapping_sub(third) << 32);
    }
    for _ in 0..REFINEMENTS {
        let r = zero.one().minus_product(j, &(y.clone() * &y * &y));
        let third = zero.constant(&T::exact(14.0 / 81.0));
        let second = zero.constant(&T::exact(2.0 / 9.0)).plus_product(&third, &r);
        let first = zero.constant(&T::exact(1.0 / 3.0)).plus_product(&second, &r);
        let step = y.clone() * &r;
        y = y.plus_product(&first, &step);
    }
    y
}
