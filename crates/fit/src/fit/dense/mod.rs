//! Small dense matrices of any kind of number, stored row by row. Of symmetric matrices only the lower triangle is
//! used.

/// Runs `$body` with the order `$n` as a constant, for the orders of the common elements: loops of known length are
/// unrolled.
macro_rules! known_order {
    ($n:ident => $body:expr) => {
        match $n {
            // Deformations of triangles (3), quadrilaterals (5) and tetrahedra (6), and the six springs of the last two
            // with the bound of the 2-norm, which is an unknown too (7).
            3 if T::UNROLLED => known_order!(@ $n, 3, $body),
            5 if T::UNROLLED => known_order!(@ $n, 5, $body),
            6 if T::UNROLLED => known_order!(@ $n, 6, $body),
            7 if T::UNROLLED => known_order!(@ $n, 7, $body),
            _ => $body,
        }
    };
    (@ $n:ident, $known:literal, $body:expr) => {{
        let $n = $known;
        $body
    }};
}

mod grouped;
mod pivot;
mod products;

pub use products::{add_outers, inner, row_products, tie, trace};

use crate::scalar::{Real, Scalar, vectorized};
use grouped::{Factorize, LEAST};
use pivot::accepted;

/// Relative pivots below this are rounding errors: some fifty units of `f64`, as the eliminations of small matrices leave.
/// [`at_rounding`] makes it the floor of numbers of another precision.
pub const FLOOR: f64 = 1e-14;

/// Subtracts the terms of the previous columns from the entries `t..t + B` of a row, in an elimination of order m.
///
/// Several entries at once, because their sums are independent, whereas the terms of one sum wait for each other.
#[inline(always)]
fn eliminate<T: Scalar, const B: usize>(row: &mut [T], before: &[T], m: usize, t: usize) {
    let (done, rest) = row.split_at_mut(t);
    let entries = &mut rest[..B];
    let (mut sums, mut others): ([T; B], [&[T]; B]) = (entries[0].repeated(), [before; B]);
    for b in 0..B {
        sums[b] = entries[b].clone();
        others[b] = &before[(t + b) * m..(t + b) * m + t + b];
    }
    for r in 0..t {
        for b in 0..B {
            sums[b] = sums[b].clone().minus_product(&done[r], &others[b][r]);
        }
    }
    for b in 1..B {
        for c in 0..b {
            sums[b] = sums[b].clone().minus_product(&sums[c], &others[b][t + c]);
        }
    }
    entries.clone_from_slice(&sums);
}

/// Row s of `A = L D Lᵀ` of order m, from the rows before it and their `1/D` in `inverse`: leaves `L_st` in the row and
/// returns the pivot `D_s`. `L_st = (A_st − Σ_{r<t} L_sr D_r L_tr)/D_t`; the row holds `L_sr D_r` until its pivot is known.
#[inline(always)]
pub fn eliminate_row<T: Scalar>(row: &mut [T], before: &[T], inverse: &[T], m: usize, s: usize) -> T {
    let mut t = 0;
    while t + 4 <= s {
        eliminate::<T, 4>(row, before, m, t);
        t += 4;
    }
    match s - t {
        1 => eliminate::<T, 1>(row, before, m, t),
        2 => eliminate::<T, 2>(row, before, m, t),
        3 => eliminate::<T, 3>(row, before, m, t),
        _ => {}
    }
    let mut pivot = row[s].clone();
    for t in 0..s {
        let scaled = row[t].clone() * &inverse[t];
        pivot = pivot.minus_product(&row[t], &scaled);
        row[t] = scaled;
    }
    pivot
}

/// The factorisation `A = L D Lᵀ`: L in the strict lower triangle, `1/D` in `inverse`. Returns the least pivot, each
/// relative to its diagonal entry. A pivot not above `floor` is replaced by a very large one, which removes its
/// direction.
pub fn factorize<T: Real>(a: &mut [T], n: usize, floor: f64, inverse: &mut [T]) -> T {
    let any = a[0].clone();
    if n >= LEAST
        && let Ok(least) = any.grouped(Factorize { a: &mut *a, n, floor, inverse: &mut *inverse })
    {
        return least;
    }
    vectorized!(any, known_order!(n => factorize_order(a, n, floor, inverse)))
}

#[inline(always)]
fn factorize_order<T: Real>(a: &mut [T], n: usize, floor: f64, inverse: &mut [T]) -> T {
    let (a, inverse) = (&mut a[..n * n], &mut inverse[..n]);
    let mut least = a[0].one();
    for s in 0..n {
        let (before, row) = a.split_at_mut(s * n);
        let row = &mut row[..=s];
        let pivot = eliminate_row(row, before, inverse, n, s);
        inverse[s] = accepted(pivot, &row[s], floor, &mut least);
    }
    least
}

/// The least pivot of one lane relative to its diagonal entry, after [`factorize`].
pub fn least_pivot<T>(a: &[T], n: usize, inverse: &[T], lane: impl Fn(&T) -> f64) -> f64 {
    (0..n).map(|s| 1.0 / (lane(&inverse[s]) * lane(&a[s * n + s]))).fold(1.0, f64::min)
}

/// `b ← A⁻¹ b`, with the factors from [`factorize`].
#[inline(always)]
pub fn solve<T: Scalar>(a: &[T], n: usize, inverse: &[T], b: &mut [T]) {
    substitute(a, n, inverse, [b]);
}

/// [`solve`] for two right-hand sides.
pub fn solve_both<T: Real>(a: &[T], n: usize, inverse: &[T], b: [&mut [T]; 2]) {
    vectorized!(a[0], known_order!(n => substitute(a, n, inverse, b)));
}

#[inline(always)]
fn substitute<T: Scalar, const R: usize>(a: &[T], n: usize, inverse: &[T], b: [&mut [T]; R]) {
    let (a, inverse, b) = (&a[..n * n], &inverse[..n], b.map(|b| &mut b[..n]));
    for s in 1..n {
        for t in 0..s {
            for r in 0..R {
                b[r][s] = b[r][s].clone().minus_product(&a[s * n + t], &b[r][t]);
            }
        }
    }
    for s in 0..n {
        for r in 0..R {
            b[r][s] = b[r][s].clone() * &inverse[s];
        }
    }
    for s in (1..n).rev() {
        for t in 0..s {
            for r in 0..R {
                b[r][t] = b[r][t].clone().minus_product(&a[s * n + t], &b[r][s]);
            }
        }
    }
}

/// `A⁻¹`, both triangles, from the factors; `rows` is working memory of the same size.
pub fn invert<T: Real>(a: &[T], n: usize, inverse: &[T], rows: &mut [T], out: &mut [T]) {
    vectorized!(a[0], known_order!(n => invert_order(a, n, inverse, rows, out)));
}

#[inline(always)]
fn invert_order<T: Real>(a: &[T], n: usize, inverse: &[T], rows: &mut [T], out: &mut [T]) {
    let (a, inverse, rows, out) = (&a[..n * n], &inverse[..n], &mut rows[..n * n], &mut out[..n * n]);
    let zero = a[0].zero();
    // L⁻¹: row i = e_i − Σ_k L_ik row k
    for i in 0..n {
        let (before, row) = rows.split_at_mut(i * n);
        for entry in &mut row[..i] {
            *entry = zero.clone();
        }
        row[i] = zero.one();
        for k in 0..i {
            let factor = &a[i * n + k];
            for j in 0..=k {
                row[j] = row[j].clone().minus_product(factor, &before[k * n + j]);
            }
        }
    }
    // A⁻¹ = L⁻ᵀ D⁻¹ L⁻¹
    for i in 0..n {
        for entry in &mut out[i * n..=i * n + i] {
            *entry = zero.clone();
        }
    }
    for k in 0..n {
        let row = &rows[k * n..=k * n + k];
        for i in 0..=k {
            let factor = row[i].clone() * &inverse[k];
            for j in 0..=i {
                out[i * n + j] = out[i * n + j].clone().plus_product(&factor, &row[j]);
            }
        }
    }
    mirror(out, n);
}

#[inline(always)]
pub fn mirror<T: Scalar>(a: &mut [T], n: usize) {
    for i in 0..n {
        for j in 0..i {
            a[j * n + i] = a[i * n + j].clone();
        }
    }
}

/// A limit that is half the digits of `f64`, in numbers of another precision.
pub fn at_half<T: Real>(limit: f64) -> f64 {
    // `epsilon` is half a unit of the last digit, twice of which is `f64::EPSILON`: the limit stays as it is in `f64`.
    limit * (2.0 * T::epsilon() / f64::EPSILON).sqrt()
}

/// A limit at the rounding error of `f64`, in numbers of another precision.
pub fn at_rounding<T: Real>(limit: f64) -> f64 {
    limit * 2.0 * T::epsilon() / f64::EPSILON
}

/// The step that takes the first κ to zero.
#[inline(always)]
pub fn longest_step<T: Real>(kappa: &[T], step: &[T]) -> T {
    // Where no κ falls, nothing limits the step.
    let mut longest = kappa[0].constant(&f64::MAX);
    for (kappa, step) in kappa.iter().zip(step) {
        let fall = step.negated();
        longest = fall.choose(&longest.least(&(kappa.clone() / &fall)), &longest);
    }
    longest
}
