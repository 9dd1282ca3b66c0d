//! Numbers with their derivatives, beside differences.

use springfit_foundation::scalar::{Dual, Real, Scalar};

#[test]
fn derivatives_are_those_of_differences() {
    let f = |x: Dual<2>, y: Dual<2>| {
        let q = (x * &y + &x.scaled(&3.0)).plus_product(&x, &x) / &(y.squared() + &y.one());
        (q.sqrt() - &y).greatest(&y.negated())
    };
    let at = |x: f64, y: f64| f(Dual::steady(x), Dual::steady(y)).value;
    let (x, y, h) = (1.3, 0.7, 1e-6);
    let found = f(Dual { value: x, slopes: [1.0, 0.0] }, Dual { value: y, slopes: [0.0, 1.0] });
    let known = [(at(x + h, y) - at(x - h, y)) / (2.0 * h), (at(x, y + h) - at(x, y - h)) / (2.0 * h)];
    // Central differences with this step have ten digits.
    assert!(found.slopes.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {known:?}");
}

#[test]
fn dual_numbers_of_dual_numbers_have_second_derivatives() {
    // f = √(x³ + y/x) along x and then along y, by hand: with s = x³ + y/x, f_xy = s_xy/(2 √s) − s_x s_y/(4 s √s).
    let number = |value: f64, along: f64, other: f64| Dual {
        value: Dual { value, slopes: [along] },
        slopes: [Dual { value: other, slopes: [0.0] }],
    };
    let (x, y) = (1.3, 0.7);
    let (a, b): (Dual<1, Dual<1>>, Dual<1, Dual<1>>) = (number(x, 1.0, 0.0), number(y, 0.0, 1.0));
    let found = (b / &a).plus_product(&a.squared(), &a).sqrt();
    let (s, s_x, s_y, s_xy) = (x * x * x + y / x, 3.0 * x * x - y / (x * x), 1.0 / x, -1.0 / (x * x));
    let known = s_xy / (2.0 * s.sqrt()) - s_x * s_y / (4.0 * s * s.sqrt());
    // A dozen operations round.
    assert!((found.slopes[0].slopes[0] - known).abs() < 1e-15, "{found:?} {known}");
    assert!((found.value.slopes[0] - s_x / (2.0 * s.sqrt())).abs() < 1e-15);
}
