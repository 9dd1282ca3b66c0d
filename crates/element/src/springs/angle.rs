//! The gradient of an angle in closed form.
//!
//! An end of a leg e turns the angle by `perp(e)/|e|²` for each length that it moves across the leg. Where the formula of the angle is
//! differentiated instead, digits cancel near 0 and π, as the square of what is left of the angle. Theory: page *Stiffness and the reduced
//! space* of the book.

use crate::scalar::{Real, Scalar};

/// The vectors r, `[3 × dimension]`, and the number q of the angle at the second of three points at `x`, `[3 × dimension]`:
/// `∇θ ∇θᵀ = q r rᵀ`, without a root. With the legs u and v and `n = u × v`, r is `u × n/|u|²` at the first point and `n × v/|v|²` at the
/// third, and q is `1/|n|²`; in the plane n is left out of both. The angle has no gradient where n is zero.
pub fn angle_row<T: Scalar>(x: &[T], dimension: usize) -> (Vec<T>, T) {
    let leg =
        |end: usize| -> Vec<T> { (0..dimension).map(|k| x[end * dimension + k].clone() - &x[dimension + k]).collect() };
    let (u, v, n) = (leg(0), leg(2), angle_normal(x, dimension));
    let zero = x[0].zero();
    let (first, last) = match n.as_slice() {
        [nx, ny, nz] => {
            let n = [nx.clone(), ny.clone(), nz.clone()];
            let last: Vec<T> = cross(&v, &n).into_iter().map(|entry| zero.clone() - &entry).collect();
            (cross(&u, &n), last)
        }
        _ => {
            let opposite = |a: &T| zero.clone() - a;
            (vec![u[1].clone(), opposite(&u[0])], vec![opposite(&v[1]), v[0].clone()])
        }
    };
    let over = |row: Vec<T>, leg: &[T]| {
        let inverse = zero.one() / &square(leg);
        row.into_iter().map(|entry| entry * &inverse).collect::<Vec<T>>()
    };
    let (first, last) = (over(first, &u), over(last, &v));
    let middle = first.iter().zip(&last).map(|(a, b)| zero.clone() - a - b).collect();
    // In space r carries the length of n, which q takes out; in the plane n is left out of r.
    let q = if dimension == 3 { zero.one() / &square(&n) } else { zero.one() };
    ([first, middle, last].concat(), q)
}

/// `u × v` of the legs of the angle at the second of three points; in the plane its single component.
pub fn angle_normal<T: Scalar>(x: &[T], dimension: usize) -> Vec<T> {
    let leg =
        |end: usize| -> Vec<T> { (0..dimension).map(|k| x[end * dimension + k].clone() - &x[dimension + k]).collect() };
    let (u, v) = (leg(0), leg(2));
    match dimension {
        3 => cross(&u, &v),
        _ => vec![u[0].clone() * &v[1] - &(u[1].clone() * &v[0])],
    }
}

/// `∇θ` of the angle at the second of three points at `x`, `[3 × dimension]`; NaN where the legs have one direction, or opposite ones.
pub fn angle_gradient<T: Real>(x: &[T], dimension: usize) -> Vec<T> {
    let (row, q) = angle_row(x, dimension);
    let n = angle_normal(x, dimension);
    let factor = match n.as_slice() {
        [turn] if turn.rounded() == 0.0 => turn.constant(&f64::NAN),
        // The angle has no sign, so that its gradient turns with the order of the legs.
        [turn] => turn.choose(&turn.one(), &turn.constant(&-1.0)),
        _ => q.sqrt(),
    };
    row.into_iter().map(|entry| entry * &factor).collect()
}

/// `|sin θ|` of that angle.
pub fn angle_sine(x: &[f64], dimension: usize) -> f64 {
    let leg = |end: usize| super::distance(&x[end * dimension..(end + 1) * dimension], &x[dimension..2 * dimension]);
    super::norm(&angle_normal(x, dimension)) / leg(0) / leg(2)
}

fn cross<T: Scalar>(a: &[T], b: &[T]) -> Vec<T> {
    let part = |k: usize, l: usize| a[k].clone() * &b[l] - &(a[l].clone() * &b[k]);
    vec![part(1, 2), part(2, 0), part(0, 1)]
}

fn square<T: Scalar>(a: &[T]) -> T {
    a.iter().fold(a[0].zero(), |sum, entry| sum.plus_product(entry, entry))
}
