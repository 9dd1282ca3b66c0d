//! One element on its deformations: R and the g_s in an orthonormal basis of all motions that are not rigid, weighted
//! and scaled to a size of one. Theory: page *Stiffness and the reduced space* of the book.

mod matrix;

use super::dense::{add_outers, factorize, inner, mirror, row_products, tie, trace};
use super::linear_motions::LinearMotions;
use super::weight::MotionWeight;
use crate::material::Hooke;
use crate::scalar::{Real, Scalar, difference, dot, of_dimension, plus_multiple, vectorized, zeros};
use crate::springs::Springs;
use crate::stiffness::{Geometry, add_stiffness};

/// `R − Σ_s k_s g_s g_sᵀ` as `size · (R̂ − Σ_I κ_I Σ_{s∈I} h_s h_sᵀ)`, one unknown κ_I per spring, or per group if
/// tied.
#[derive(Debug, Clone)]
pub struct Reduced<T> {
    /// The order of the matrices: 2n − 3 or 3n − 6.
    pub order: usize,
    /// `R̂`, `[order × order]`, of trace `order`; both triangles.
    pub stiffness: Vec<T>,
    /// `h_s`, `[springs × order]`.
    pub gradients: Vec<T>,
    /// The unknown of each spring.
    pub unknowns: Vec<usize>,
    /// `k_I = scale_I κ_I`.
    pub scales: Vec<T>,
    /// N/m, or 1 if the weight removes the unit.
    pub size: T,
    /// What the weight divides by, N/m, or 1.
    unit: T,
    /// The least pivot of R̂ relative to its diagonal, if the weight divides by R: about the softest over the stiffest
    /// motion.
    pub softest: T,
    mix: Vec<T>,
    nodal: Vec<T>,
    work: Vec<T>,
    /// Orthonormal rows that sum to zero, `[nodes − 1 × nodes]`: differences, which translations do not change.
    differences: Vec<f64>,
    norms: Vec<T>,
}

/// Where the stiffness comes from.
#[derive(Clone, Copy)]
pub enum Source<'a, T> {
    /// An element.
    Element(&'a Geometry<T>, &'a Hooke<T>),
    /// A matrix, `[nodes·dimension × nodes·dimension]`, with springs on lengths alone.
    Matrix(&'a [T]),
}

impl<T: Real> Reduced<T> {
    /// Memory for elements with these springs; `any` selects the kind of number.
    pub fn like(any: &T, springs: &Springs, tied: bool) -> Reduced<T> {
        let (n, d, m) = (springs.nodes(), springs.dimension(), springs.len());
        let unknowns = if tied { springs.groups().to_vec() } else { (0..m).collect() };
        let count = unknowns.iter().max().map_or(0, |last| last + 1);
        let full = (n - 1) * d;
        let order = full - d * (d - 1) / 2;
        let room = |size: usize| vec![any.zero(); size];
        Reduced {
            order,
            stiffness: room(full * full),
            gradients: room(m * full),
            unknowns,
            scales: room(count),
            size: any.one(),
            unit: any.one(),
            softest: any.one(),
            mix: room((n - 1) * n),
            nodal: room((n - 1) * d),
            work: room(full * (d + 2)),
            differences: differences(n),
            norms: room(m),
        }
    }

    /// Fills in the element or the matrix with nodes at `x`. `measured` has the gradients of springs on functions, `[functions × nodes·dimension]`.
    pub fn set(&mut self, weight: MotionWeight, springs: &Springs, x: &[T], source: Source<T>, measured: &[T]) {
        vectorized!(
            x[0],
            of_dimension!(springs.dimension(), |D| self.set_in::<D>(weight, springs, x, source, measured))
        );
    }

    #[inline(always)]
    fn set_in<const D: usize>(
        &mut self,
        weight: MotionWeight,
        springs: &Springs,
        x: &[T],
        source: Source<T>,
        measured: &[T],
    ) {
        let n = springs.nodes();
        let x = &x.as_chunks::<D>().0[..n];
        self.set_mix(weight, x);
        let content = match source {
            Source::Matrix(r) => {
                self.mix_matrix::<D>(n, r);
                None
            }
            Source::Element(geometry, hooke) => {
                match geometry.is_condensed() {
                    true => self.mix_matrix::<D>(n, &geometry.entries(hooke)),
                    false => self.set_stiffness::<D>(n, geometry, hooke),
                }
                springs.content().map(|_| geometry.content_gradient())
            }
        };
        self.set_gradients(springs, x, measured, content.as_deref());
        // The rows of `mix` add up to zero, which took out the translations; the rotations are left.
        self.take_out_rotations::<D>(n);
        if weight.divides_by_stiffness() {
            self.divide_by_stiffness();
        }
        self.normalise();
    }

    /// The map from nodes to differences, `[nodes − 1 × nodes]`. For modal weights it is multiplied by `h + (1 − h) P`,
    /// with P the projection on the linear motions, `X S⁻¹ Xᵀ`, X the positions in differences and `S = XᵀX`.
    #[inline(always)]
    fn set_mix<const D: usize>(&mut self, weight: MotionWeight, x: &[[T; D]]) {
        let n = x.len();
        let zero = x[0][0].zero();
        for (mix, plain) in self.mix.iter_mut().zip(&self.differences) {
            *mix = zero.constant(plain);
        }
        let positions = self.nodal.as_chunks_mut::<D>().0;
        for (position, row) in positions.iter_mut().zip(self.differences.chunks_exact(n)) {
            *position = zeros(&zero);
            for (x, c) in x.iter().zip(row) {
                *position = plus_multiple(position, &zero.constant(c), x);
            }
        }
        let Some(higher) = weight.higher() else { return };
        let higher = higher.value();
        let (rest, q) = (zero.constant(&(1.0 - higher)), self.work[..(n - 1) * D].as_chunks_mut::<D>().0);
        q.clone_from_slice(positions);
        let linear = LinearMotions::of(q);
        for (row, r) in self.mix.chunks_exact_mut(n).zip(&*q) {
            let image = linear.weighted(&rest, r);
            for entry in row.iter_mut() {
                *entry = entry.clone().scaled(&higher);
            }
            for (other, plain) in q.iter().zip(self.differences.chunks_exact(n)) {
                let projection = dot(&image, other);
                for (entry, c) in row.iter_mut().zip(plain) {
                    *entry = entry.clone().plus_product(&projection, &zero.constant(c));
                }
            }
        }
    }

    /// `Σ_q v Bᵀ D B`, if isotropic `Σ_q v (λ ∇_a ∇_bᵀ + μ (∇_b ∇_aᵀ + ∇_a·∇_b I))`, with the gradients of the differences.
    #[inline(always)]
    fn set_stiffness<const D: usize>(&mut self, n: usize, geometry: &Geometry<T>, hooke: &Hooke<T>) {
        let full = (n - 1) * D;
        let zero = geometry.volumes[0].zero();
        let r = &mut self.stiffness[..full * full];
        for entry in r.iter_mut() {
            *entry = zero.clone();
        }
        let differences = self.work[..full].as_chunks_mut::<D>().0;
        for (grad, v, w) in geometry.each_point() {
            mixed(&self.mix, grad.as_chunks::<D>().0, differences);
            add_stiffness(r, differences, hooke, v, w);
        }
    }

    #[inline(always)]
    fn set_gradients<const D: usize>(
        &mut self,
        springs: &Springs,
        x: &[[T; D]],
        measured: &[T],
        content: Option<&[T]>,
    ) {
        let n = x.len();
        let full = (n - 1) * D;
        self.set_lengths(springs, x);
        for (s, g) in (springs.pairs().len()..).zip(measured.chunks_exact(n * D)) {
            mixed(&self.mix, g.as_chunks::<D>().0, self.gradients[s * full..][..full].as_chunks_mut::<D>().0);
            self.norms[s] = self.size.one();
        }
        if let Some(c) = content {
            let last = springs.len() - 1;
            mixed(&self.mix, c.as_chunks::<D>().0, self.gradients[last * full..][..full].as_chunks_mut::<D>().0);
            self.norms[last] = self.size.one();
        }
    }

    /// The gradients of springs on lengths.
    #[inline(always)]
    fn set_lengths<const D: usize>(&mut self, springs: &Springs, x: &[[T; D]]) {
        let n = x.len();
        let full = (n - 1) * D;
        for ((g, norm), &[i, j]) in self.gradients.chunks_exact_mut(full).zip(&mut self.norms).zip(springs.pairs()) {
            let d = difference(&x[j], &x[i]);
            *norm = norm.one() / &dot(&d, &d);
            for (g, row) in g.as_chunks_mut::<D>().0.iter_mut().zip(self.mix.chunks_exact(n)) {
                let factor = row[j].clone() - &row[i];
                for k in 0..D {
                    g[k] = d[k].clone() * &factor;
                }
            }
        }
    }

    /// Householder reflections that turn each rotation into the last remaining coordinate, which is then removed.
    #[inline(always)]
    fn take_out_rotations<const D: usize>(&mut self, n: usize) {
        let full = (n - 1) * D;
        let zero = self.size.zero();
        let planes = &[(0, 1), (0, 2), (1, 2)][..D * (D - 1) / 2];
        let (rotations, work) = self.work.split_at_mut(full * planes.len());
        let positions = self.nodal.as_chunks::<D>().0;
        for (rotation, &(k, l)) in rotations.chunks_exact_mut(full).zip(planes) {
            for (u, x) in rotation.as_chunks_mut::<D>().0.iter_mut().zip(positions) {
                *u = zeros(&zero);
                u[k] = x[l].negated();
                u[l] = x[k].clone();
            }
        }
        for done in 0..planes.len() {
            let active = full - done;
            let (axis, rest) = rotations[done * full..].split_at_mut(full);
            let v = &mut axis[..active];
            // v = ρ ± ‖ρ‖ e_last, with the sign that avoids cancellation; β = 2/vᵀv
            let norm = inner(v, v).sqrt();
            let signed = v[active - 1].choose(&norm, &norm.negated());
            v[active - 1] = v[active - 1].clone() + &signed;
            let beta = zero.one() / &(signed * &v[active - 1]);
            let v = &*v;
            for other in rest.chunks_exact_mut(full).chain(self.gradients.chunks_exact_mut(full)) {
                let factor = inner(v, &other[..active]) * &beta;
                for (entry, v) in other.iter_mut().zip(v) {
                    *entry = entry.clone().minus_product(&factor, v);
                }
            }
            // R ← R − v wᵀ − w vᵀ, w = β R v − (β² vᵀ R v/2) v
            let w = &mut work[..active];
            let r = &mut self.stiffness;
            mirror(r, full);
            for i in 0..active {
                w[i] = inner(&r[i * full..i * full + active], v) * &beta;
            }
            let half = (inner(w, v) * &beta).scaled(&0.5);
            for (w, v) in w.iter_mut().zip(v) {
                *w = w.clone().minus_product(&half, v);
            }
            for i in 0..active {
                for j in 0..=i {
                    let entry = r[i * full + j].clone().minus_product(&v[i], &w[j]);
                    r[i * full + j] = entry.minus_product(&w[i], &v[j]);
                }
            }
        }
        // The remaining leading entries, packed.
        let p = self.order;
        for i in 0..p {
            for j in 0..p {
                self.stiffness[i * p + j] = self.stiffness[i.max(j) * full + i.min(j)].clone();
            }
        }
        for s in 0..self.gradients.len() / full {
            for i in 0..p {
                self.gradients[s * p + i] = self.gradients[s * full + i].clone();
            }
        }
    }

    /// `h ← R̂^(−1/2) h`, with the Cholesky factor instead of the root, from which it differs by a rotation. R̂ has a
    /// trace of `order` before, because roots of numbers whose ratio is an odd power of two round differently.
    #[inline(always)]
    fn divide_by_stiffness(&mut self) {
        let p = self.order;
        let zero = self.size.zero();
        self.unit = trace(&self.stiffness, p).scaled(&(1.0 / p as f64));
        let inverse = zero.one() / &self.unit;
        for entry in &mut self.stiffness[..p * p] {
            *entry = entry.clone() * &inverse;
        }
        let inverse = &mut self.work[..p];
        self.softest = factorize(&mut self.stiffness[..p * p], p, 0.0, inverse);
        for h in self.gradients[..self.norms.len() * p].chunks_exact_mut(p) {
            for i in 1..p {
                let mut sum = h[i].clone();
                for j in 0..i {
                    sum = sum.minus_product(&self.stiffness[i * p + j], &h[j]);
                }
                h[i] = sum;
            }
            for i in 0..p {
                h[i] = h[i].clone() * &inverse[i].clone().sqrt();
            }
        }
        for i in 0..p {
            for j in 0..p {
                self.stiffness[i * p + j] = if i == j { zero.one() } else { zero.clone() };
            }
        }
    }

    /// Scales R̂ to the trace `order`, and the h of every unknown to a mean square of one.
    #[inline(always)]
    fn normalise(&mut self) {
        let (p, m) = (self.order, self.norms.len());
        let zero = self.size.zero();
        self.size = trace(&self.stiffness, p).scaled(&(1.0 / p as f64));
        let inverse = zero.one() / &self.size;
        for entry in &mut self.stiffness[..p * p] {
            *entry = entry.clone() * &inverse;
        }
        // ‖g‖² per unknown; length springs have g in terms of d instead of n = d/‖d‖.
        for scale in &mut self.scales {
            *scale = zero.clone();
        }
        for s in 0..m {
            let h = &self.gradients[s * p..(s + 1) * p];
            let square = inner(h, h) * &self.norms[s];
            let of = self.unknowns.iter().filter(|i| **i == self.unknowns[s]).count();
            let scale = &mut self.scales[self.unknowns[s]];
            *scale = scale.clone() + &square.scaled(&(1.0 / of as f64));
        }
        for s in 0..m {
            let factor = (self.norms[s].clone() / &self.scales[self.unknowns[s]]).sqrt();
            for entry in &mut self.gradients[s * p..(s + 1) * p] {
                *entry = entry.clone() * &factor;
            }
        }
        for scale in &mut self.scales {
            *scale = self.size.clone() * &self.unit / scale;
        }
    }

    /// `E ← R̂ − Σ κ_I Σ h_s h_sᵀ`, lower triangle.
    #[inline(always)]
    pub fn residual(&self, kappa: &[T], e: &mut [T]) {
        let p = self.order;
        e[..p * p].clone_from_slice(&self.stiffness[..p * p]);
        add_outers(e, self.rows(), p, kappa, &self.unknowns, -1.0);
    }

    /// The Gram matrix `Σ_{s∈I, t∈J} (h_s·h_t)²`, lower triangle; `products` receives `h_s·h_t`, `[springs × springs]`.
    pub fn gram(&self, products: &mut [T], out: &mut [T]) {
        let (h, count) = (self.rows(), self.scales.len());
        row_products(h, h, self.order, true, products);
        vectorized!(self.size, {
            tie(
                products,
                products,
                &self.unknowns,
                count,
                count,
                out,
                #[inline(always)]
                |a, b| a.clone() * b,
            )
        });
    }

    /// The common value of all κ at which the springs are on average as stiff as the element.
    #[inline(always)]
    pub fn uniform(&self) -> T {
        let rows = self.rows();
        trace(&self.stiffness, self.order) / &inner(rows, rows)
    }

    /// `h_s`, `[springs × order]`.
    #[inline(always)]
    pub fn rows(&self) -> &[T] {
        &self.gradients[..self.unknowns.len() * self.order]
    }
}

/// `out = C u`, rows of vectors.
#[inline(always)]
fn mixed<T: Scalar, const D: usize>(mix: &[T], u: &[[T; D]], out: &mut [[T; D]]) {
    for (out, row) in out.iter_mut().zip(mix.chunks_exact(u.len())) {
        *out = zeros(&row[0].zero());
        for (u, c) in u.iter().zip(row) {
            *out = plus_multiple(out, c, u);
        }
    }
}

/// The Helmert matrix: row i has `1/√(i(i+1))` i times, then `−i/√(i(i+1))`.
fn differences(nodes: usize) -> Vec<f64> {
    let mut rows = vec![0.0; (nodes - 1) * nodes];
    for (row, i) in rows.chunks_exact_mut(nodes).zip(1..) {
        let scale = 1.0 / ((i * (i + 1)) as f64).sqrt();
        row[..i].fill(scale);
        row[i] = -(i as f64) * scale;
    }
    rows
}
