//! Numbers with their derivatives, beside differences.

use springfit::scalar::{Dual, Real, Scalar};

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
