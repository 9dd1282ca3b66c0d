//! The plain Frobenius fit of elements with many springs, by the equations of their nodes.
//!
//! Two length springs interact only through the diagonal blocks of the nodes that they share: `M = 2I + V W Vᵀ`, where
//! row s of V holds the entries on and below the diagonal of `n_s n_sᵀ` once for each end of the spring, and W counts
//! those below the diagonal twice. With d(d+1)/2 entries per node this has a lower rank than the number of springs from
//! eight nodes on in the plane and from fourteen in space, and `M⁻¹ b = ½ (b − V S⁻¹ Vᵀ b)`, `S = 2W⁻¹ + VᵀV` (Woodbury 1950).
//!
//! Theory: page *Least squares* of the book.

use super::bounded::{Gradients, Product, bound};
use super::dense::solve as substitute;
use super::edge_cell::EdgeCell;
use super::normal::Normal;
use super::weight::ClosedWeight;
use crate::material::Hooke;
use crate::scalar::{Packed, Scalar, vectorized};
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// Working memory for the equations of the nodes, of which there are d(d+1)/2 for each node.
#[derive(Debug, Clone)]
pub struct NodeEquations<T> {
    /// `S`, with `Vᵀ b` as its right-hand side.
    small: Normal<T>,
    /// `V`, `[springs × d(d+1)/2]`: the entries, which are equal at both ends.
    entries: Vec<T>,
    /// The right-hand side b.
    energies: Vec<T>,
    /// The row of the content in M, and then its image `A⁻¹ c`.
    border: Vec<T>,
    image: Vec<T>,
}

impl<T> Default for NodeEquations<T> {
    fn default() -> NodeEquations<T> {
        NodeEquations { small: Normal::default(), entries: vec![], energies: vec![], border: vec![], image: vec![] }
    }
}

/// Whether the equations of the nodes are fewer than those of the springs, in the plane or in space.
pub fn is_shorter(springs: &Springs) -> bool {
    // The equations of the nodes are compiled for the plane and for space alone.
    if springs.dimension() < 2 {
        return false;
    }
    let small = springs.nodes() * springs.dimension() * (springs.dimension() + 1) / 2;
    !springs.need_matrix() && springs.parallel().is_empty() && 5 * small < 4 * springs.pairs().len()
}

impl<T: Scalar> NodeEquations<T> {
    /// Writes the constants of the element with nodes at `x`, `[nodes × dimension]`, into `normal.rhs`; false if a pivot
    /// vanishes.
    pub fn solve(
        &mut self,
        springs: &Springs,
        x: &[T],
        geometry: &Geometry<T>,
        hooke: &Hooke<T>,
        normal: &mut Normal<T>,
    ) -> bool {
        vectorized!(
            x[0],
            match springs.dimension() {
                2 => self.solve_in::<2>(springs, x, geometry, hooke, normal),
                _ => self.solve_in::<3>(springs, x, geometry, hooke, normal),
            }
        )
    }

    #[inline(always)]
    fn solve_in<const D: usize>(
        &mut self,
        springs: &Springs,
        x: &[T],
        geometry: &Geometry<T>,
        hooke: &Hooke<T>,
        normal: &mut Normal<T>,
    ) -> bool {
        let (n, m, lengths) = (springs.nodes(), springs.len(), springs.pairs().len());
        let x = &x.as_chunks::<D>().0[..n];
        let Normal { rhs, edges, inverse_squares, .. } = normal;
        let cell = EdgeCell::<T, D>::new(springs, x, geometry, hooke, edges, inverse_squares, rhs);
        cell.plain_energies(rhs);
        let zero = x[0][0].zero();
        self.border.clear();
        self.border.resize(m, zero.clone());
        if springs.content().is_some() {
            cell.content(ClosedWeight::None, &mut self.border, rhs);
        }
        self.energies.clone_from(rhs);
        // The entries stay for products under bounds and for other right-hand sides.
        self.set_entries(&cell);
        self.set_small::<D>(springs, &zero);
        // k = A⁻¹ b of the length springs alone.
        self.gather::<D>(springs, rhs);
        if !self.small.solve_regular() {
            return false;
        }
        self.scatter::<D>(springs, rhs);
        // The border would be empty, and `rhs` has no entry after those of the lengths.
        if springs.content().is_none() {
            return true;
        }
        // M = [A c; cᵀ e]: the constant of the content is (b_e − cᵀ A⁻¹ b)/(e − cᵀ A⁻¹ c).
        // The factor of the nodes is that of A alone: one more substitution, for c, serves as the elimination of the border.
        self.image.clone_from(&self.border);
        let mut image = std::mem::take(&mut self.image);
        self.solve_lengths::<D>(springs, &mut image);
        self.image = image;
        // The pivot of the content, by the rule of all normal equations: a thousand rounding errors count as zero. Lanes whose pivot vanishes
        // hold numbers that are not finite here; the result is refused as a whole.
        let pivot = self.solve_content(rhs);
        pivot.exceeds(&self.border[lengths].clone().scaled(&T::exact(1e3 * T::epsilon())))
    }

    /// `w ← A⁻¹ w` by the factor of the nodes.
    #[inline(always)]
    fn solve_lengths<const D: usize>(&mut self, springs: &Springs, w: &mut [T]) {
        self.gather::<D>(springs, w);
        let Normal { gram, rhs: small, pivots, .. } = &mut self.small;
        substitute(gram, small.len(), pivots, small);
        self.scatter::<D>(springs, w);
    }

    /// Goes on from `A⁻¹ w` to `M⁻¹ w`; the pivot of the content, `e − cᵀ A⁻¹ c`.
    #[inline(always)]
    fn solve_content(&self, w: &mut [T]) -> T {
        let lengths = w.len() - 1;
        let (mut above, mut below) = (w[lengths].clone(), self.border[lengths].clone());
        for s in 0..lengths {
            above = above.minus_product(&self.border[s], &w[s]);
            below = below.minus_product(&self.border[s], &self.image[s]);
        }
        let constant = above / &below;
        for s in 0..lengths {
            w[s] = w[s].clone().minus_product(&constant, &self.image[s]);
        }
        w[lengths] = constant;
        below
    }

    /// `w ← M⁻¹ w` for another right-hand side, after [`NodeEquations::solve`].
    #[inline(always)]
    pub fn solve_again(&mut self, springs: &Springs, w: &mut [T]) {
        match springs.dimension() {
            2 => self.solve_again_in::<2>(springs, w),
            _ => self.solve_again_in::<3>(springs, w),
        }
    }

    #[inline(always)]
    fn solve_again_in<const D: usize>(&mut self, springs: &Springs, w: &mut [T]) {
        self.solve_lengths::<D>(springs, w);
        if springs.content().is_some() {
            self.solve_content(w);
        }
    }

    /// `n_k n_l`, l ≤ k, of every length spring.
    #[inline(always)]
    fn set_entries<const D: usize>(&mut self, cell: &EdgeCell<T, D>) {
        self.entries.clear();
        for (d, q) in cell.edges.iter().zip(cell.q) {
            for k in 0..D {
                let scaled = d[k].clone() * q;
                for l in 0..=k {
                    self.entries.push(scaled.clone() * &d[l]);
                }
            }
        }
    }

    /// The lower triangle of S: a block of two nodes from the one spring between them, a block of one node from all of
    /// its springs.
    #[inline(always)]
    fn set_small<const D: usize>(&mut self, springs: &Springs, zero: &T) {
        let width = D * (D + 1) / 2;
        let size = springs.nodes() * width;
        let gram = &mut self.small.gram;
        gram.clear();
        gram.resize(size * size, zero.clone());
        for a in 0..springs.nodes() {
            let mut entry = 0;
            for k in 0..D {
                for l in 0..=k {
                    let at = a * width + entry;
                    // `2 W⁻¹`: W is 1 on the diagonal of a block and 2 below it.
                    gram[at * size + at] = zero.constant(&T::exact(if k == l { 2.0 } else { 1.0 }));
                    entry += 1;
                }
            }
        }
        for (v, &[i, j]) in self.entries.chunks_exact(width).zip(springs.pairs()) {
            let (low, high) = (i.min(j), i.max(j));
            for k in 0..width {
                for l in 0..width {
                    let product = v[k].clone() * &v[l];
                    // Rows and columns are nodes; only blocks on and below the diagonal are kept, and of those on it the lower triangle.
                    for (row, column) in [(low, low), (high, high), (high, low)] {
                        if row != column || l <= k {
                            let place = &mut gram[(row * width + k) * size + column * width + l];
                            *place = place.clone() + &product;
                        }
                    }
                }
            }
        }
    }

    /// Writes `Vᵀ b` into the small right-hand side.
    #[inline(always)]
    fn gather<const D: usize>(&mut self, springs: &Springs, b: &[T]) {
        let width = D * (D + 1) / 2;
        let small = &mut self.small.rhs;
        small.clear();
        small.resize(springs.nodes() * width, b[0].zero());
        for ((v, b), pair) in self.entries.chunks_exact(width).zip(b).zip(springs.pairs()) {
            for &a in pair {
                for (sum, v) in small[a * width..(a + 1) * width].iter_mut().zip(v) {
                    *sum = sum.clone().plus_product(v, b);
                }
            }
        }
    }

    /// `b ← ½ (b − V y)`, with y in the small right-hand side.
    #[inline(always)]
    fn scatter<const D: usize>(&self, springs: &Springs, b: &mut [T]) {
        let width = D * (D + 1) / 2;
        let half = T::exact(0.5);
        for ((v, b), pair) in self.entries.chunks_exact(width).zip(b).zip(springs.pairs()) {
            for &a in pair {
                for (y, v) in self.small.rhs[a * width..(a + 1) * width].iter().zip(v) {
                    *b = b.clone().minus_product(v, y);
                }
            }
            *b = b.clone().scaled(&half);
        }
    }
}

/// Products with `M = 2I + V W Vᵀ`, whose eigenvalues are between 2 and four times the springs of a node, for length springs; scaled so that the
/// diagonal entry of the content is 4 as well.
pub struct NodalProduct<'a, T> {
    springs: &'a Springs,
    entries: &'a [T],
    /// The row of the content, empty without a spring on it.
    border: Vec<T>,
    scale: Vec<T>,
    /// `W Vᵀ` of a vector, `[nodes × d(d+1)/2]`.
    sums: Vec<T>,
}

impl<T: Packed> NodeEquations<T> {
    /// Replaces the constants of these lanes, after [`NodeEquations::solve`], by the optimum under `k ≥ 0`; false if the iterations for it do
    /// not end.
    pub fn bound(&self, springs: &Springs, k: &mut [T], lanes: &[usize]) -> bool {
        let zero = k[0].zero();
        let (mut scale, mut border) = (vec![zero.one(); springs.len()], Vec::new());
        if let (Some(_), Some((entry, row))) = (springs.content(), self.border.split_last()) {
            // A length has the diagonal entry 4. With the same for the content all slopes have one tolerance.
            let content = zero.constant(&2.0) / &entry.clone().sqrt();
            border = row.iter().map(|c| c.clone() * &content).collect();
            scale[row.len()] = content;
        }
        let sums = vec![zero; self.small.size()];
        let product = NodalProduct { springs, entries: &self.entries, border, scale, sums };
        bound(&mut Gradients::new(product), &self.energies, k, lanes)
    }
}

impl<T: Packed> Product<T> for NodalProduct<'_, T> {
    fn scale(&self) -> &[T] {
        &self.scale
    }

    #[inline(always)]
    fn multiply(&mut self, vector: &[T], image: &mut [T]) {
        match self.springs.dimension() {
            2 => self.multiply_in::<3>(vector, image),
            _ => self.multiply_in::<6>(vector, image),
        }
    }
}

impl<T: Packed> NodalProduct<'_, T> {
    /// W is the number of entries of a node: (1,1), (2,1), (2,2), (3,1), …
    #[inline(always)]
    fn multiply_in<const W: usize>(&mut self, vector: &[T], image: &mut [T]) {
        let NodalProduct { springs, entries, border, sums, .. } = self;
        sums.fill(vector[0].zero());
        let (sums, entries) = (sums.as_chunks_mut::<W>().0, entries.as_chunks::<W>().0);
        for ((v, p), pair) in entries.iter().zip(vector).zip(springs.pairs()) {
            for &a in pair {
                for (sum, v) in sums[a].iter_mut().zip(v) {
                    *sum = sum.clone().plus_product(v, p);
                }
            }
        }
        for sums in sums.iter_mut() {
            for (entry, sum) in sums.iter_mut().enumerate() {
                // W counts entries below the diagonal twice, and 0, 2 and 5 are (1,1), (2,2) and (3,3).
                if !matches!(entry, 0 | 2 | 5) {
                    *sum = sum.clone() + &sum.clone();
                }
            }
        }
        for (((v, p), pair), image) in entries.iter().zip(vector).zip(springs.pairs()).zip(&mut *image) {
            let mut sum = p.clone() + p;
            for &a in pair {
                for (y, v) in sums[a].iter().zip(v) {
                    sum = sum.plus_product(v, y);
                }
            }
            *image = sum;
        }
        if springs.content().is_some() {
            let last = border.len();
            let content = &vector[last];
            let mut sum = content.clone().scaled(&T::exact(4.0));
            for ((c, p), image) in border.iter().zip(vector).zip(image.iter_mut()) {
                *image = image.clone().plus_product(c, content);
                sum = sum.plus_product(c, p);
            }
            image[last] = sum;
        }
    }
}
