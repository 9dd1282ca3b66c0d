//! The springs of an element as rows, whatever they measure and in any kind of number, and the normal equations of rows.
//!
//! The closed forms of [`least_squares`](super::least_squares) take springs on lengths and on the content of the cell. Rows are for formulas, and for springs on functions in
//! numbers of more digits. Theory: page *Least squares* of the book.

use super::dense::inner;
use super::edge_cell::scales;
use super::linear_motions::{LinearMotions, from_mean};
use super::normal::Normal;
use super::weight::{ClosedWeight, Higher};
use crate::scalar::{Scalar, dot, of_dimension, plus_multiple, zeros};
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// `g_s g_sᵀ = q_s r_s r_sᵀ` of each spring; a length has `r = (−d, d)` and `q = 1/|d|²`, so that no root is taken.
#[derive(Debug, Clone)]
pub struct Rows<T> {
    dimension: usize,
    size: usize,
    /// r, `[springs × nodes·dimension]`.
    rows: Vec<T>,
    /// q, `[springs]`.
    squares: Vec<T>,
}

impl<T: Scalar> Rows<T> {
    /// The springs of the element with nodes at `x`, `[nodes × dimension]`. `functions` has r, `[functions × nodes·dimension]`, and q of
    /// those on functions.
    pub fn new(springs: &Springs, x: &[T], geometry: &Geometry<T>, functions: (Vec<T>, Vec<T>)) -> Rows<T> {
        let (d, size, zero) = (springs.dimension(), x.len(), x[0].zero());
        let (mut rows, mut squares) = (Vec::new(), Vec::new());
        for &[i, j] in springs.pairs() {
            let mut row = vec![zero.clone(); size];
            let mut square = zero.clone();
            for k in 0..d {
                let along = x[j * d + k].clone() - &x[i * d + k];
                square = square.plus_product(&along, &along);
                row[i * d + k] = zero.clone() - &along;
                row[j * d + k] = along;
            }
            rows.extend(row);
            squares.push(zero.one() / &square);
        }
        rows.extend(functions.0);
        squares.extend(functions.1);
        if springs.content().is_some() {
            rows.extend(geometry.content_gradient());
            // The gradient of the content needs no root, so that its factor is one.
            squares.push(zero.one());
        }
        Rows { dimension: d, size, rows, squares }
    }

    /// [`Rows::new`] with the gradients `g`, `[functions × nodes·dimension]`, of the springs on functions.
    pub fn of_gradients(springs: &Springs, x: &[T], geometry: &Geometry<T>, g: Vec<T>) -> Rows<T> {
        let ones = vec![x[0].one(); springs.functions().len()];
        Rows::new(springs, x, geometry, (g, ones))
    }

    fn each(&self) -> impl Iterator<Item = (&[T], &T)> {
        self.rows.chunks_exact(self.size).zip(&self.squares)
    }

    /// The normal equations of the element with nodes at `x` and the stiffness `r`, `[nodes·dimension × nodes·dimension]`.
    pub fn normal(&self, weight: ClosedWeight, x: &[T], r: &[T]) -> Normal<T> {
        match weight {
            ClosedWeight::None => Normal::new(self.gram(&self.rows), self.works(r, false)),
            ClosedWeight::OffDiagonal => Normal::new(self.gram_of_blocks(), self.works(r, true)),
            ClosedWeight::Modal(higher) => {
                let images = Rows { rows: self.images(higher, x), ..self.clone() };
                Normal::new(self.gram(&images.rows), images.works(r, false))
            }
        }
    }

    /// `g_sᵀ R g_s` of every spring, over all blocks or over those of different nodes.
    pub fn works(&self, r: &[T], off_diagonal: bool) -> Vec<T> {
        let (d, zero) = (self.dimension, self.squares.first().map(Scalar::zero));
        let work = |(row, q): (&[T], &T)| {
            let mut sum = zero.clone().unwrap_or_else(|| q.zero());
            for (i, r) in r.chunks_exact(self.size).enumerate() {
                let mut force = q.zero();
                // The blocks of one node with itself are left out where those of different nodes alone count.
                for (j, entry) in r.iter().enumerate().filter(|(j, _)| !(off_diagonal && i / d == j / d)) {
                    force = force.plus_product(entry, &row[j]);
                }
                sum = sum.plus_product(&row[i], &force);
            }
            sum * q
        };
        self.each().map(work).collect()
    }

    /// `(g_s·y_t)²`, `[springs × springs]`, with y the rows `images`.
    fn gram(&self, images: &[T]) -> Vec<T> {
        self.pairwise(|s, t| {
            let product = inner(&self.rows[s * self.size..][..self.size], &images[t * self.size..][..self.size]);
            // The product of `g_s g_sᵀ` with `g_t g_tᵀ` is the square of `g_s · g_t`.
            product.clone() * &product
        })
    }

    /// `(g_s·g_t)² − Σ_a (g_sa·g_ta)²`.
    fn gram_of_blocks(&self) -> Vec<T> {
        let d = self.dimension;
        self.pairwise(|s, t| {
            let [a, b] = [s, t].map(|s| &self.rows[s * self.size..][..self.size]);
            let (mut all, mut alone) = (a[0].zero(), a[0].zero());
            for (a, b) in a.chunks_exact(d).zip(b.chunks_exact(d)) {
                let product = inner(a, b);
                alone = alone.plus_product(&product, &product);
                all = all + &product;
            }
            all.clone() * &all - &alone
        })
    }

    /// A symmetric matrix from its entries without the q.
    fn pairwise(&self, entry: impl Fn(usize, usize) -> T) -> Vec<T> {
        let m = self.squares.len();
        let mut gram: Vec<T> = self.squares.iter().flat_map(|q| std::iter::repeat_n(q.zero(), m)).collect();
        for s in 0..m {
            for t in 0..=s {
                gram[s * m + t] = entry(s, t) * &self.squares[s] * &self.squares[t];
                gram[t * m + s] = gram[s * m + t].clone();
            }
        }
        gram
    }

    /// `y_s = h² r_s + (1 − h²) P r_s`, with P the projection on the linear motions.
    fn images(&self, higher: Higher, x: &[T]) -> Vec<T> {
        of_dimension!(self.dimension, |D| self.images_in::<D>(higher, x))
    }

    fn images_in<const D: usize>(&self, higher: Higher, x: &[T]) -> Vec<T> {
        let x = x.as_chunks::<D>().0;
        let zero = x[0][0].zero();
        let (h2, rest) = scales(&zero, higher);
        let mut q = x.to_vec();
        from_mean(x, &mut q);
        let linear = LinearMotions::of(&mut q);
        let mut images = self.rows.clone();
        for (image, row) in images.chunks_exact_mut(self.size).zip(self.rows.chunks_exact(self.size)) {
            let row = row.as_chunks::<D>().0;
            for k in 0..D {
                let mut along: [T; D] = zeros(&zero);
                for (g, q) in row.iter().zip(&q) {
                    along = plus_multiple(&along, &g[k], q);
                }
                let along = linear.weighted(&rest, &along);
                for (a, q) in q.iter().enumerate() {
                    image[a * D + k] = dot(q, &along).plus_product(&h2, &row[a][k]);
                }
            }
        }
        images
    }
}
