//! The content that the tangents of a cell of dimension D in a space of S span, and its derivatives, one cell per lane.

use crate::scalar::Packed;

#[inline(always)]
fn cross<T: Packed>(zero: &T, a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    let mut c: [T; 3] = zero.repeated();
    for k in 0..3 {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        c[k] = (a[l].clone() * &b[m]).minus_product(&a[m], &b[l]);
    }
    c
}

#[inline(always)]
pub fn dot<T: Packed>(a: &[T; 3], b: &[T; 3]) -> T {
    (a[0].clone() * &b[0]).plus_product(&a[1], &b[1]).plus_product(&a[2], &b[2])
}

#[inline(always)]
fn unit<T: Packed>(n: &[T; 3]) -> [T; 3] {
    let length = dot(n, n).sqrt();
    let mut unit = n.clone();
    for k in 0..3 {
        unit[k] = n[k].clone() / &length;
    }
    unit
}

/// c of these tangents.
#[inline(always)]
pub fn content<T: Packed, const D: usize, const S: usize>(zero: &T, t: &[[T; 3]; 3]) -> T {
    match (D == S, D) {
        (true, _) => dot(&t[0], &cross(zero, &t[1], &t[2])),
        (false, 1) => dot(&t[0], &t[0]).sqrt(),
        (false, _) => {
            let n = cross(zero, &t[0], &t[1]);
            dot(&n, &n).sqrt()
        }
    }
}

/// `∂c/∂t_l`.
#[inline(always)]
pub fn slopes<T: Packed, const D: usize, const S: usize>(zero: &T, t: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    match (D == S, D) {
        (true, _) => [cross(zero, &t[1], &t[2]), cross(zero, &t[2], &t[0]), cross(zero, &t[0], &t[1])],
        (false, 1) => [unit(&t[0]), zero.repeated(), zero.repeated()],
        (false, _) => {
            let n = unit(&cross(zero, &t[0], &t[1]));
            [cross(zero, &t[1], &n), cross(zero, &n, &t[0]), zero.repeated()]
        }
    }
}
