//! Products of rows, and sums of them.

use super::grouped::{AddOuters, LEAST, RowProducts};
use crate::scalar::{Real, Scalar, vectorized};

/// `out_st = a_s · b_t` for rows of length n; with `lower` only the lower triangle of a square result.
///
/// Computed in blocks of four rows by four, so that each number that is loaded serves four sums.
pub fn row_products<T: Real>(a: &[T], b: &[T], n: usize, lower: bool, out: &mut [T]) {
    if b.len() >= LEAST * n && a[0].grouped(RowProducts { a, b, n, lower, out: &mut *out }).is_ok() {
        return;
    }
    vectorized!(a[0], known_order!(n => row_products_order(a, b, n, lower, out)));
}

#[inline(always)]
fn row_products_order<T: Real>(a: &[T], b: &[T], n: usize, lower: bool, out: &mut [T]) {
    let (rows, columns) = (a.len() / n, b.len() / n);
    let mut s = 0;
    // Of four rows and four columns each number that is read serves four of the sixteen sums, which stay in registers.
    // Up to three entries of a row above the diagonal come along: they cost less than shorter blocks.
    while s + 4 <= rows {
        row_block::<T, 4>(a, b, n, s, if lower { s + 4 } else { columns }, columns, out);
        s += 4;
    }
    // The last rows reach to the last column, whether the upper triangle is wanted or not. Blocks of three would double the code of all.
    if s + 2 <= rows {
        row_block::<T, 2>(a, b, n, s, columns, columns, out);
        s += 2;
    }
    if s < rows {
        row_block::<T, 1>(a, b, n, s, columns, columns, out);
    }
}

#[inline(always)]
fn row_block<T: Scalar, const A: usize>(
    a: &[T],
    b: &[T],
    n: usize,
    s: usize,
    last: usize,
    columns: usize,
    out: &mut [T],
) {
    let mut t = 0;
    while t + 4 <= last {
        products::<T, A, 4>(a, b, n, s, t, columns, out);
        t += 4;
    }
    if t + 2 <= last {
        products::<T, A, 2>(a, b, n, s, t, columns, out);
        t += 2;
    }
    if t < last {
        products::<T, A, 1>(a, b, n, s, t, columns, out);
    }
}

#[inline(always)]
fn products<T: Scalar, const A: usize, const B: usize>(
    a: &[T],
    b: &[T],
    n: usize,
    s: usize,
    t: usize,
    columns: usize,
    out: &mut [T],
) {
    let (mut left, mut right): ([&[T]; A], [&[T]; B]) = ([a; A], [b; B]);
    for i in 0..A {
        left[i] = &a[(s + i) * n..(s + i + 1) * n];
    }
    for j in 0..B {
        right[j] = &b[(t + j) * n..(t + j + 1) * n];
    }
    let mut sums: [[T; B]; A] = a[0].zero().repeated_rows();
    for k in 0..n {
        for i in 0..A {
            for j in 0..B {
                sums[i][j] = sums[i][j].clone().plus_product(&left[i][k], &right[j][k]);
            }
        }
    }
    for i in 0..A {
        for j in 0..B {
            out[(s + i) * columns + t + j] = sums[i][j].clone();
        }
    }
}

/// `a · b`.
#[inline(always)]
pub fn inner<T: Scalar>(a: &[T], b: &[T]) -> T {
    let mut sum = a[0].zero();
    for (a, b) in a.iter().zip(b) {
        sum = sum.plus_product(a, b);
    }
    sum
}

/// `A ← A ± Σ_I c_I Σ_{s∈I} g_s g_sᵀ`, lower triangle, for rows g of the order n of A; `unknowns` gives the I of each
/// row.
pub fn add_outers<T: Real>(a: &mut [T], g: &[T], n: usize, c: &[T], unknowns: &[usize], sign: f64) {
    if n >= LEAST && c[0].grouped(AddOuters { a: &mut *a, g, n, c, unknowns, sign }).is_ok() {
        return;
    }
    vectorized!(c[0], known_order!(n => add_outers_order(a, g, n, c, unknowns, sign)));
}

#[inline(always)]
fn add_outers_order<T: Real>(a: &mut [T], g: &[T], n: usize, c: &[T], unknowns: &[usize], sign: f64) {
    let a = &mut a[..n * n];
    let rows = g.len() / n;
    let mut s = 0;
    // Four rows at a time read and write the sum once for four products.
    while s + 4 <= rows {
        let mut factors: [T; 4] = c[0].repeated();
        for i in 0..4 {
            factors[i] = c[unknowns[s + i]].clone().scaled(&sign);
        }
        outers(a, g, n, s, factors);
        s += 4;
    }
    while s < rows {
        outers(a, g, n, s, [c[unknowns[s]].clone().scaled(&sign)]);
        s += 1;
    }
}

#[inline(always)]
fn outers<T: Scalar, const A: usize>(a: &mut [T], g: &[T], n: usize, s: usize, c: [T; A]) {
    let mut rows: [&[T]; A] = [g; A];
    for r in 0..A {
        rows[r] = &g[(s + r) * n..(s + r + 1) * n];
    }
    for i in 0..n {
        let mut factors = c.clone();
        for r in 0..A {
            factors[r] = factors[r].clone() * &rows[r][i];
        }
        // The matrix is symmetric, and its lower triangle alone is read.
        for j in 0..=i {
            let mut sum = a[i * n + j].clone();
            for r in 0..A {
                sum = sum.plus_product(&factors[r], &rows[r][j]);
            }
            a[i * n + j] = sum;
        }
    }
}

/// The trace.
#[inline(always)]
pub fn trace<T: Scalar>(a: &[T], n: usize) -> T {
    let mut sum = a[0].zero();
    for i in 0..n {
        sum = sum + &a[i * n + i];
    }
    sum
}

/// Sums `term(a_st, b_st)` over the springs of each pair of unknowns; lower triangle of width `width`.
#[inline(always)]
pub fn tie<T: Scalar>(
    a: &[T],
    b: &[T],
    unknowns: &[usize],
    count: usize,
    width: usize,
    out: &mut [T],
    term: impl Fn(&T, &T) -> T,
) {
    let m = unknowns.len();
    // One spring for each unknown.
    if m == count && unknowns.iter().enumerate().all(|(s, &i)| s == i) {
        for s in 0..m {
            let (a, b, out) = (&a[s * m..=s * m + s], &b[s * m..=s * m + s], &mut out[s * width..=s * width + s]);
            for t in 0..=s {
                out[t] = term(&a[t], &b[t]);
            }
        }
        return;
    }
    let zero = a[0].zero();
    for i in 0..count {
        for j in 0..=i {
            out[i * width + j] = zero.clone();
        }
    }
    for (s, &i) in unknowns.iter().enumerate() {
        for (t, &j) in unknowns[..=s].iter().enumerate() {
            let term = term(&a[s * m + t], &b[s * m + t]);
            let sum = &mut out[i.max(j) * width + i.min(j)];
            // The pairs (s, t) and (t, s) both belong to the entry of an unknown with itself, whereas of different
            // unknowns only one of the two is in the lower triangle.
            *sum = if i == j && s != t { sum.clone() + &term + &term } else { sum.clone() + &term };
        }
    }
}
