//! Compensated sums.

use springfit_foundation::scalar::Sum;

/// Ten million tenths, of which a plain sum is off by 1e-4; and a term that is gone when the large ones are.
#[test]
fn nothing_is_lost() {
    let sum: Sum = std::iter::repeat_n(0.1, 10_000_000).collect();
    assert!((sum.value() - 1e6).abs() < 1e-9, "{}", sum.value());
    assert_eq!([1.0, 1e100, 1.0, -1e100].into_iter().collect::<Sum>().value(), 2.0);
    assert_eq!([f64::MAX, f64::MAX].into_iter().collect::<Sum>().value(), f64::INFINITY);
}
