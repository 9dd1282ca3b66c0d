//! Chebyshev's polynomials in `D⁻¹ A`, D the blocks of the diagonal.

use crate::block::{Block, add_product};
use crate::entry::Entry;
use crate::matrix::BlockMatrix;
use crate::parallel::{PIECE, combine, dot, vectorized};
use crate::random::Random;
use crate::tridiagonal::Tridiagonal;
use rayon::prelude::*;

/// Steps of Lanczos' method for the largest eigenvalue. The smoother needs no more digits than its margin has.
// Conjugate gradients take as many iterations, to one, after 6 to 60 steps, on a box of hexahedra and on a bar of
// tetrahedra with Poisson's ratio 0.45. After three the bound is too small, and the equations are not solved.
const STEPS: usize = 15;
/// Their Ritz value is below the eigenvalue by less than this share of it. A bound below the eigenvalue would let the
/// polynomial grow beyond it, and the errors there with it.
// With a factor of 1 iterations are one or two fewer than with 1.1 there, and with 0.9 they lead nowhere. With 1.3
// there are one or two more, and with 2 half as many more.
const SAFETY: f64 = 1.1;

/// Polynomial smoothing of errors between `upper / ratio` and `upper`.
#[derive(Debug, Clone)]
pub(crate) struct Smoother<const N: usize> {
    /// D⁻¹, zero in what is held.
    pub inverse: Vec<Block<N, N>>,
    /// A bound of the eigenvalues of `D⁻¹ A`.
    pub upper: f64,
    degree: usize,
    ratio: f64,
}

/// Vectors of a level.
#[derive(Debug, Clone, Default)]
pub(crate) struct Room<const N: usize, T = f64> {
    pub residual: Vec<[T; N]>,
    direction: Vec<[T; N]>,
    pub next: Vec<[T; N]>,
}

impl<const N: usize, T: Entry> Room<N, T> {
    pub fn new(rows: usize) -> Room<N, T> {
        let [residual, direction, next] = std::array::from_fn(|_| vec![[T::ZERO; N]; rows]);
        Room { residual, direction, next }
    }
}

impl<const N: usize> Smoother<N> {
    pub fn new(a: &BlockMatrix<N, N>, inverse: Vec<Block<N, N>>, degree: usize, ratio: f64) -> Smoother<N> {
        let upper = SAFETY * largest(a, &inverse);
        Smoother { inverse, upper, degree, ratio }
    }

    /// The largest size of what the polynomial leaves of an error between zero and `upper`, squared: `max q(λ)²` over the interval that
    /// it damps; below it q rises to 1 at zero.
    pub fn damping(&self) -> f64 {
        let (theta, delta) = self.interval();
        let x = theta / delta;
        let chebyshev = (self.degree as f64 * x.acosh()).cosh();
        1.0 / (chebyshev * chebyshev)
    }

    /// Middle and half width.
    fn interval(&self) -> (f64, f64) {
        let lower = self.upper / self.ratio;
        (0.5 * (self.upper + lower), 0.5 * (self.upper - lower))
    }

    /// Adds to x the polynomial's part of the error, whose residual is in `room.residual`, and leaves the new residual there if `wanted`.
    pub fn smooth<T: Entry>(&self, a: &BlockMatrix<N, N>, x: &mut [[T; N]], room: &mut Room<N, T>, wanted: bool) {
        let (theta, delta) = self.interval();
        let sigma = theta / delta;
        // The recurrence is that of Saad, Iterative Methods for Sparse Linear Systems, algorithm 12.1.
        let mut rho = 1.0 / sigma;
        let inverse = &self.inverse;
        let Room { residual, direction, next } = room;
        let begin = |piece: usize, x: &mut [[T; N]], r: &[[T; N]], d: &mut [[T; N]]| {
            vectorized(
                #[inline(always)]
                || {
                    for (((row, x), r), d) in (piece * PIECE..).zip(x).zip(r).zip(d) {
                        let mut z = [T::ZERO; N];
                        add_product(&mut z, &inverse[row], r);
                        for k in 0..N {
                            d[k] = z[k] / theta;
                            x[k] += d[k];
                        }
                    }
                },
            );
        };
        x.par_chunks_mut(PIECE)
            .zip(residual.par_chunks(PIECE))
            .zip(direction.par_chunks_mut(PIECE))
            .enumerate()
            .for_each(|(piece, ((x, r), d))| begin(piece, x, r, d));
        for _ in 1..self.degree {
            let after = 1.0 / (2.0 * sigma - rho);
            let (keep, add) = (after * rho, 2.0 * after / delta);
            rho = after;
            // Rows that are still to come read the last direction of their neighbours, so that the new one is written beside it.
            let old = &*direction;
            let step = |piece: usize, x: &mut [[T; N]], r: &mut [[T; N]], d: &mut [[T; N]]| {
                vectorized(
                    #[inline(always)]
                    || {
                        for (((row, x), r), d) in (piece * PIECE..).zip(x).zip(r).zip(d) {
                            // The product, the residual and the next direction are worked out in one pass: memory is what takes the time.
                            let product = a.row_product(row, old);
                            let mut z = [T::ZERO; N];
                            (0..N).for_each(|k| r[k] -= product[k]);
                            add_product(&mut z, &inverse[row], r);
                            for k in 0..N {
                                d[k] = old[row][k] * keep + z[k] * add;
                                x[k] += d[k];
                            }
                        }
                    },
                );
            };
            x.par_chunks_mut(PIECE)
                .zip(residual.par_chunks_mut(PIECE))
                .zip(next.par_chunks_mut(PIECE))
                .enumerate()
                .for_each(|(piece, ((x, r), d))| step(piece, x, r, d));
            std::mem::swap(direction, next);
        }
        if wanted {
            a.each_row(residual, direction, |r, product| (0..N).for_each(|k| r[k] -= product[k]));
        }
    }
}

pub(crate) fn scale<T: Entry, const N: usize>(inverse: &[Block<N, N>], x: &[[T; N]], y: &mut [[T; N]]) {
    y.par_chunks_mut(PIECE).zip(x.par_chunks(PIECE)).zip(inverse.par_chunks(PIECE)).for_each(|((y, x), inverse)| {
        for ((y, x), inverse) in y.iter_mut().zip(x).zip(inverse) {
            *y = [T::ZERO; N];
            add_product(y, inverse, x);
        }
    });
}

/// The largest Ritz value of `D⁻¹ A` after some steps of Lanczos' method from a random vector, in the inner product of D.
fn largest<const N: usize>(a: &BlockMatrix<N, N>, inverse: &[Block<N, N>]) -> f64 {
    let rows = a.rows();
    let mut force = Random::new(1).vector::<N>(rows);
    let mut before = vec![[0.0; N]; rows];
    let mut motion = vec![[0.0; N]; rows];
    let mut t = Tridiagonal::default();
    let mut beside = 0.0;
    for _ in 0..STEPS {
        scale(inverse, &force, &mut motion);
        let size = dot(&force, &motion).max(0.0).sqrt();
        // All that the operator reaches is spanned, and a further vector would be divided by zero.
        if !(size > 0.0 && size.is_finite()) {
            break;
        }
        if !t.diagonal.is_empty() {
            // What is left is rounding: the vectors span all that the operator reaches, and a further one would be
            // noise.
            if size <= 1e-12 * t.diagonal[0].abs() {
                break;
            }
            t.beside.push(size);
            beside = size;
        }
        force.par_chunks_mut(PIECE).for_each(|f| f.as_flattened_mut().iter_mut().for_each(|x| *x /= size));
        motion.par_chunks_mut(PIECE).for_each(|m| m.as_flattened_mut().iter_mut().for_each(|x| *x /= size));
        // What is next is `A v − α D v − β D v₋`, with `force = D v`.
        let mut image = vec![[0.0; N]; rows];
        a.apply(&motion, &mut image);
        let along = dot(&image, &motion);
        t.diagonal.push(along);
        combine(&mut image, 1.0, &force, -along);
        combine(&mut image, 1.0, &before, -beside);
        before = std::mem::replace(&mut force, image);
    }
    // Where nothing is free there is no eigenvalue, and any bound above zero serves.
    t.extremes().map_or(1.0, |[_, high]| high).max(f64::MIN_POSITIVE)
}
