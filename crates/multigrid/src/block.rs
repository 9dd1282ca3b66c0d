//! Small dense blocks.

use crate::entry::Entry;

/// A dense block, row after row.
pub type Block<const R: usize, const C: usize> = [[f64; C]; R];

/// A pivot below this share of its diagonal entry is rounding.
// A pivot is a difference of at most N ≤ 6 numbers of the size of the entry, which rounding changes by less than 1e-15 of it.
const ROUNDING: f64 = 1e-14;

pub(crate) const fn zero<const R: usize, const C: usize>() -> Block<R, C> {
    [[0.0; C]; R]
}

/// `y ← y + a x`.
#[inline(always)]
pub(crate) fn add_product<T: Entry, const R: usize, const C: usize>(y: &mut [T; R], a: &Block<R, C>, x: &[T; C]) {
    for i in 0..R {
        for j in 0..C {
            y[i] += x[j] * a[i][j];
        }
    }
}

/// `y ← y + aᵀ x`.
#[inline(always)]
pub(crate) fn add_transposed_product<T: Entry, const R: usize, const C: usize>(
    y: &mut [T; C],
    a: &Block<R, C>,
    x: &[T; R],
) {
    for i in 0..R {
        for j in 0..C {
            y[j] += x[i] * a[i][j];
        }
    }
}

/// `c ← c + a b`.
#[inline(always)]
pub(crate) fn add_block_product<const R: usize, const K: usize, const C: usize>(
    c: &mut Block<R, C>,
    a: &Block<R, K>,
    b: &Block<K, C>,
) {
    for i in 0..R {
        for k in 0..K {
            for j in 0..C {
                c[i][j] += a[i][k] * b[k][j];
            }
        }
    }
}

/// `c ← c + aᵀ b`.
#[inline(always)]
pub(crate) fn add_transposed_block_product<const K: usize, const R: usize, const C: usize>(
    c: &mut Block<R, C>,
    a: &Block<K, R>,
    b: &Block<K, C>,
) {
    for k in 0..K {
        for i in 0..R {
            for j in 0..C {
                c[i][j] += a[k][i] * b[k][j];
            }
        }
    }
}

pub(crate) fn transposed<const R: usize, const C: usize>(a: &Block<R, C>) -> Block<C, R> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// The square of Frobenius' norm.
pub(crate) fn square<const R: usize, const C: usize>(a: &Block<R, C>) -> f64 {
    a.as_flattened().iter().map(|x| x * x).sum()
}

/// The inverse of a symmetric block on the unknowns that are `free`, zero in the rows and columns of the others; `None` where the block
/// is not positive definite there.
pub fn inverse<const N: usize>(a: &Block<N, N>, free: &[bool; N]) -> Option<Block<N, N>> {
    // L of L Lᵀ, with unit rows for what is not free.
    let mut l = zero::<N, N>();
    for i in 0..N {
        for j in 0..=i {
            let entry = if free[i] && free[j] { a[i][j] } else { f64::from(u8::from(i == j)) };
            let rest = entry - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            if i == j {
                // The comparison is negated so that a pivot that is not a number is refused as well.
                if !(rest > ROUNDING * entry && rest.is_finite()) {
                    return None;
                }
                l[i][i] = rest.sqrt();
            } else {
                l[i][j] = rest / l[j][j];
            }
        }
    }
    let mut inverse = zero::<N, N>();
    for column in (0..N).filter(|c| free[*c]) {
        let mut x = [0.0; N];
        for i in column..N {
            let rest = f64::from(u8::from(i == column)) - (column..i).map(|k| l[i][k] * x[k]).sum::<f64>();
            x[i] = rest / l[i][i];
        }
        for i in (0..N).rev() {
            x[i] = (x[i] - (i + 1..N).map(|k| l[k][i] * x[k]).sum::<f64>()) / l[i][i];
        }
        (0..N).filter(|i| free[*i]).for_each(|i| inverse[i][column] = x[i]);
    }
    Some(inverse)
}

/// The eigenvector of the least eigenvalue of a symmetric block on the unknowns that are `free`: Jacobi's rotations.
pub fn softest<const N: usize>(a: &Block<N, N>, free: &[bool; N]) -> [f64; N] {
    let mut a = *a;
    let mut v = zero::<N, N>();
    for i in 0..N {
        v[i][i] = 1.0;
        for j in 0..N {
            if !free[i] || !free[j] {
                a[i][j] = 0.0;
            }
        }
    }
    // The rotations converge quadratically: after a few sweeps only zeros are left, which are passed over.
    for _ in 0..60 {
        for p in 0..N {
            for q in p + 1..N {
                // The quotient below would divide by the zero that is wanted.
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                // Of the two angles that make the entry zero this is the one of at most 45°, with which the cyclic method converges
                // (Forsythe and Henrici 1960). Equal diagonal entries give theta = 0, whose signum is 1, and an angle of 45°.
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..N {
                    (a[k][p], a[k][q]) = (c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]);
                }
                for k in 0..N {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                    (v[k][p], v[k][q]) = (c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]);
                }
            }
        }
    }
    // The rows that are not free have the eigenvalue zero, which would pass for the least one.
    let least = (0..N).filter(|i| free[*i]).min_by(|i, j| a[*i][*i].total_cmp(&a[*j][*j]));
    least.map_or([0.0; N], |least| std::array::from_fn(|k| v[k][least]))
}
