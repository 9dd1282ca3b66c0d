//! The extreme eigenvalues of small symmetric matrices, one per lane: Householder's tridiagonal form, then Laguerre's iteration from
//! outside the spectrum.
//!
//! With `p` the characteristic polynomial, `G = p′/p` and `H = G² − p″/p`, the step `n/(G + √((n − 1)(nH − G²)))` from above the largest
//! eigenvalue λ never passes it (Wilkinson, *The Algebraic Eigenvalue Problem*, 1965, 7.§14). As `G = Σ 1/(x − λ_i) ≤ n/(x − λ)`, what is left is at most
//! `n/G`: this bound ends the iteration.

use crate::scalar::{Real, vectorized};

/// What is left, at most, relative to the largest row sum of the matrix. Rounding of the recurrence leaves about as
/// much.
const LEFT: f64 = 1e-13;
/// Steps at most. Each at least halves the distance of an eigenvalue of multiplicity three; a lane that is not there then keeps its bound.
const STEPS: usize = 100;

/// Memory for matrices of one order.
pub struct Extremes<T> {
    order: usize,
    diagonal: Vec<T>,
    /// Squares of the entries beside the diagonal.
    beside: Vec<T>,
    work: Vec<T>,
}

impl<T: Real> Extremes<T> {
    /// `any` selects the kind of number.
    pub fn like(any: &T, order: usize) -> Extremes<T> {
        let room = || vec![any.zero(); order];
        Extremes { order, diagonal: room(), beside: room(), work: room() }
    }

    /// The induced 2-norm of the symmetric matrix whose lower triangle is in `a`, `[order × order]`, which is overwritten.
    pub fn norm(&mut self, a: &mut [T]) -> T {
        let any = a[0].clone();
        vectorized!(any, {
            let (size, sum) = row_sums(a, self.order);
            // A matrix of zeros is left as it is.
            // The largest row sum bounds all eigenvalues (Gershgorin): after
            // division they are from −1 to 1, and no square of an entry overflows.
            let inverse = any.one() / &size.choose(&size, &any.one());
            for entry in a.iter_mut() {
                *entry = entry.clone() * &inverse;
            }
            self.reduce(a);
            let (high, low) = (self.end(1.0), self.end(-1.0));
            // Numbers that are not finite stay so.
            (high.greatest(&low).greatest(&any.zero()) * &size).plus_product(&sum, &any.zero())
        })
    }

    /// Householder's reflections from the last row up; the tridiagonal form into `diagonal` and `beside`.
    #[inline(always)]
    fn reduce(&mut self, a: &mut [T]) {
        let n = self.order;
        let zero = a[0].zero();
        for last in (1..n).rev() {
            // The row left of the diagonal becomes ± its length at its end.
            let (above, row) = a.split_at_mut(last * n);
            let (row, own) = row.split_at_mut(last);
            self.diagonal[last] = own[0].clone();
            let mut rest = zero.clone();
            for entry in &row[..last - 1] {
                rest = rest.plus_product(entry, entry);
            }
            let end = row[last - 1].clone();
            let square = rest.clone().plus_product(&end, &end);
            self.beside[last] = square.clone();
            if last == 1 {
                break;
            }
            let length = square.sqrt();
            // The sign is that of the entry, so that the sum below does not cancel.
            let signed = end.choose(&length, &length.negated());
            row[last - 1] = end + &signed;
            // β = 2/vᵀv, zero where there is nothing to reflect.
            let half = signed * &row[last - 1];
            let beta = rest.choose(&(zero.one() / &half.choose(&half, &zero.one())), &zero);
            let (v, w) = (&*row, &mut self.work[..last]);
            for entry in w.iter_mut() {
                *entry = zero.clone();
            }
            // w = A v from the lower triangle.
            for i in 0..last {
                let line = &above[i * n..i * n + i + 1];
                let mut sum = line[i].clone() * &v[i];
                for j in 0..i {
                    sum = sum.plus_product(&line[j], &v[j]);
                    w[j] = w[j].clone().plus_product(&line[j], &v[i]);
                }
                w[i] = w[i].clone() + &sum;
            }
            let mut along = zero.clone();
            for (w, v) in w.iter_mut().zip(v) {
                *w = w.clone() * &beta;
                along = along.plus_product(w, v);
            }
            let half = (along * &beta).scaled(&0.5);
            for (w, v) in w.iter_mut().zip(v) {
                *w = w.clone().minus_product(&half, v);
            }
            for i in 0..last {
                let line = &mut above[i * n..i * n + i + 1];
                for (j, entry) in line.iter_mut().enumerate() {
                    *entry = entry.clone().minus_product(&v[i], &w[j]).minus_product(&w[i], &v[j]);
                }
            }
        }
        self.diagonal[0] = a[0].clone();
    }

    /// The largest eigenvalue of the tridiagonal form times `sign`; row sums are at most one.
    #[inline(always)]
    fn end(&self, sign: f64) -> T {
        let n = self.order as f64;
        let any = &self.diagonal[0];
        let (zero, one) = (any.zero(), any.one());
        let constant = |value: f64| any.constant(&value);
        let (left, size, rest) = (constant(LEFT), constant(n), constant(n - 1.0));
        // Above all eigenvalues, which row sums of one bound, by more than the rounding of those sums.
        let mut x = constant(1.0 + 1e-12);
        for _ in 0..STEPS {
            // The pivots q of x − T, and the sums of the first and second derivatives of their logarithms.
            let (mut g, mut h) = (zero.clone(), zero.clone());
            let (mut inverse, mut first, mut second) = (zero.clone(), zero.clone(), zero.clone());
            for (i, (d, e)) in self.diagonal.iter().zip(&self.beside).enumerate() {
                let mut q = x.clone().minus_product(d, &constant(sign));
                let (mut slope, mut bend) = (one.clone(), zero.clone());
                if i > 0 {
                    // q = x − d − e/q₋, q′ = 1 + e q₋′/q₋², q″ = e (q₋″ − 2 q₋′²/q₋)/q₋²
                    let share = e.clone() * &inverse;
                    let squared = share.clone() * &inverse;
                    q = q - &share;
                    slope = slope.plus_product(&squared, &first);
                    let twice = (first.clone() * &first).scaled(&2.0) * &inverse;
                    bend = squared * &(second - &twice);
                }
                inverse = one.clone() / &q;
                let growth = slope.clone() * &inverse;
                g = g + &growth;
                // −(log q)″ = (q′/q)² − q″/q
                h = h.plus_product(&growth, &growth).minus_product(&bend, &inverse);
                (first, second) = (slope, bend);
            }
            let room = size.clone() / &g;
            let moves = room - &left;
            let spread = (size.clone() * &h).minus_product(&g, &g) * &rest;
            // The spread is zero where all eigenvalues are equal, and rounding may leave it below zero.
            let root = spread.choose(&spread, &zero).sqrt();
            let step = size.clone() / &(g + &root);
            // A lane that has arrived, or whose numbers are not finite, stays where it is.
            let next = moves.choose(&(x.clone() - &step), &x);
            if left.exceeds(&(moves.choose(&step, &zero))) {
                return next;
            }
            x = next;
        }
        x
    }
}

/// The largest sum of the magnitudes of a row, and that of all rows.
#[inline(always)]
fn row_sums<T: Real>(a: &[T], n: usize) -> (T, T) {
    let (mut largest, mut all) = (a[0].zero(), a[0].zero());
    for i in 0..n {
        let mut sum = a[0].zero();
        for j in 0..n {
            sum = sum + &a[i.max(j) * n + i.min(j)].magnitude();
        }
        all = all + &sum;
        largest = largest.greatest(&sum);
    }
    (largest, all)
}
