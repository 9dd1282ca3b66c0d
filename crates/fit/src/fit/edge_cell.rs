//! The cell of a fit with a closed form: what its springs measure, and the work of the material along their motions.
//!
//! Theory: page *Least squares* of the book.

use super::linear_motions::{LinearMotions, from_mean};
use super::weight::{ClosedWeight, Higher};
use crate::material::{Hooke, Moduli, Stiffness, strains, voigt};
use crate::scalar::{Scalar, difference, dot, vectorized, zeros};
use crate::springs::Springs;
use crate::stiffness::Geometry;

/// One element, or one per lane, with the vectors of its length springs.
pub struct EdgeCell<'a, T, const D: usize> {
    springs: &'a Springs,
    x: &'a [[T; D]],
    /// `d_s = x_j − x_i`
    pub edges: &'a [[T; D]],
    /// `1/‖d_s‖²`
    pub q: &'a [T],
    geometry: &'a Geometry<T>,
    hooke: &'a Hooke<T>,
}

impl<'a, T: Scalar, const D: usize> EdgeCell<'a, T, D> {
    /// Fills `edges` and `q` with those of the element, and `rhs` with zeros.
    #[inline(always)]
    pub fn new(
        springs: &'a Springs,
        x: &'a [[T; D]],
        geometry: &'a Geometry<T>,
        hooke: &'a Hooke<T>,
        edges: &'a mut Vec<T>,
        q: &'a mut Vec<T>,
        rhs: &mut Vec<T>,
    ) -> EdgeCell<'a, T, D> {
        let zero = x[0][0].zero();
        let lengths = springs.pairs().len();
        rhs.clear();
        rhs.resize(springs.len(), zero.clone());
        edges.resize(lengths * D, zero.clone());
        q.resize(lengths, zero.clone());
        let edges = edges.as_chunks_mut::<D>().0;
        for ((d, q), &[i, j]) in edges.iter_mut().zip(&mut *q).zip(springs.pairs()) {
            *d = difference(&x[j], &x[i]);
            // `n nᵀ = d dᵀ/(d·d)`: without the length itself no root is taken, and fractions have the same kernel.
            *q = zero.one() / &dot(d, d);
        }
        EdgeCell { springs, x, edges, q: &q[..lengths], geometry, hooke }
    }

    /// `b_s = g_sᵀ R g_s` of the length springs.
    #[inline(always)]
    pub fn plain_energies(&self, rhs: &mut [T]) {
        let pairs = self.springs.pairs();
        self.energies(
            rhs,
            #[inline(always)]
            |s, grad: &[[T; D]]| Gradients::Same(difference(&grad[pairs[s][1]], &grad[pairs[s][0]])),
        );
    }

    /// `(n_s·n_t)²`.
    #[inline(always)]
    pub fn cosine_squared(&self, s: usize, t: usize) -> T {
        dot(&self.edges[s], &self.edges[t]).squared() * &(self.q[s].clone() * &self.q[t])
    }

    /// Adds the works `∫ (n yᵀ) : D : (n zᵀ) dV` of motions with the gradients `n yᵀ` and `n zᵀ` that `gradients(s, …)` makes of
    /// those of the nodes at a quadrature point.
    #[inline(always)]
    pub fn energies(&self, rhs: &mut [T], gradients: impl Fn(usize, &[[T; D]]) -> Gradients<T, D>) {
        let rhs = &mut rhs[..self.q.len()];
        match self.hooke {
            Hooke::Isotropic(moduli) => self.isotropic(rhs, moduli, gradients),
            Hooke::Anisotropic(stiffness) => self.anisotropic(rhs, stiffness.compiled(), gradients),
        }
    }

    /// `(λ + μ)(n·y)(n·z) + μ y·z`
    #[inline(always)]
    fn isotropic(&self, rhs: &mut [T], moduli: &Moduli<T>, gradients: impl Fn(usize, &[[T; D]]) -> Gradients<T, D>) {
        let n = self.x.len();
        for (grad, v, w) in self.geometry.each_point() {
            let grad = &grad.as_chunks::<D>().0[..n];
            let across = moduli.mu.clone() * v;
            let along = (moduli.lambda.clone() * w) + &across;
            for (s, b) in rhs.iter_mut().enumerate() {
                let gradients = gradients(s, grad);
                let energy = b.clone().plus_product(&across, &gradients.product());
                *b = energy.plus_product(&(along.clone() * &self.q[s]), &gradients.product_along(&self.edges[s]));
            }
        }
    }

    /// `yᵀ A z` with the acoustic tensor `A_jl = n_k n_m D_kjml` of the spring's direction.
    #[inline(always)]
    fn anisotropic(
        &self,
        rhs: &mut [T],
        stiffness: &Stiffness<T>,
        gradients: impl Fn(usize, &[[T; D]]) -> Gradients<T, D>,
    ) {
        let (n, acoustic) = (self.x.len(), Acoustic::of::<D>(stiffness));
        for (s, b) in rhs.iter_mut().enumerate() {
            let tensor = acoustic.along(&self.edges[s]);
            let mut sum = b.zero();
            for (grad, v, w) in self.geometry.each_point() {
                let gradients = gradients(s, &grad.as_chunks::<D>().0[..n]);
                let (y, z) = gradients.both();
                let mut image: [T; D] = zeros(&sum);
                for j in 0..D {
                    image[j] = dot(&tensor[j], z);
                }
                // The stiffness is summed with v as a whole; what a rule of the volumetric part changes is the term with λ alone.
                let volumetric = (w.clone() - v) * stiffness.lambda();
                sum = sum.plus_product(v, &dot(y, &image));
                sum = sum.plus_product(&volumetric, &gradients.product_along(&self.edges[s]));
            }
            *b = b.clone().plus_product(&sum, &self.q[s]);
        }
    }

    /// The last row of `M` and entry of `b`, of the spring on the cell's content, whose `g` is `c = ∫ ∇N dV`. With V
    /// the content, `P c = V S⁻¹ r_a`, because `Σ_a r_a ∇N_aᵀ = I`.
    pub fn content(&self, weight: ClosedWeight, row: &mut [T], rhs: &mut [T]) {
        vectorized!(self.x[0][0], self.add_content(weight, row, rhs));
    }

    #[inline(always)]
    fn add_content(&self, weight: ClosedWeight, row: &mut [T], rhs: &mut [T]) {
        let last = self.springs.len() - 1;
        let zero = self.x[0][0].zero();
        let two = zero.one() + &zero.one();
        let gradient = self.geometry.content_gradient();
        let c = gradient.as_chunks::<D>().0;
        let (mut cc, mut fourth) = (zero.clone(), zero.clone());
        for c in c {
            let size = dot(c, c);
            cc = cc + &size;
            fourth = fourth.plus_product(&size, &size);
        }
        let volume = self.geometry.content();
        // y_a = h² c_a + (1 − h²) V S⁻¹ r_a, ∇y = h² Σ_a c_a ∇N_aᵀ + linear
        let (mut h2, mut linear) = (zero.one(), zero.repeated_rows());
        let mut q = self.x.to_vec();
        let mut motions = None;
        match weight {
            ClosedWeight::None | ClosedWeight::OffDiagonal => {}
            ClosedWeight::Modal(higher) => {
                let rest;
                (h2, rest) = scales(&zero, higher);
                from_mean(self.x, &mut q);
                let (found, factor) = (LinearMotions::of(&mut q), rest * &volume);
                linear = found.inverse_spread(&factor);
                motions = Some((found, factor));
            }
        }
        for (s, &[i, j]) in self.springs.pairs().iter().enumerate() {
            let d = &self.edges[s];
            row[s] = match weight {
                ClosedWeight::OffDiagonal => {
                    zero.clone() - &(two.clone() * &self.q[s] * &dot(d, &c[i]) * &dot(d, &c[j]))
                }
                ClosedWeight::None | ClosedWeight::Modal(_) => {
                    let mut along = h2.clone() * &dot(d, &difference(&c[j], &c[i]));
                    if let Some((motions, factor)) = &motions {
                        let turned = difference(&q[j], &q[i]);
                        along = along + &dot(&turned, &motions.weighted(factor, &turned));
                    }
                    along.squared() * &self.q[s]
                }
            };
        }
        row[last] = match weight {
            ClosedWeight::OffDiagonal => cc.squared() - &fourth,
            ClosedWeight::None | ClosedWeight::Modal(_) => {
                let mut trace = linear[0][0].clone();
                for k in 1..D {
                    trace = trace + &linear[k][k];
                }
                (h2.clone() * &cc).plus_product(&trace, &volume).squared()
            }
        };
        for (grad, v, w) in self.geometry.each_point() {
            let grad = grad.as_chunks::<D>().0;
            let mut h = linear.clone();
            let mut alone = zero.clone();
            for (c, g) in c.iter().zip(grad) {
                let mut outer: [[T; D]; D] = zero.repeated_rows();
                for k in 0..D {
                    for l in 0..D {
                        outer[k][l] = c[k].clone() * &g[l];
                        h[k][l] = h[k][l].clone().plus_product(&h2, &outer[k][l]);
                    }
                }
                if weight == ClosedWeight::OffDiagonal {
                    alone = alone + &self.energy(&outer, v, w);
                }
            }
            rhs[last] = rhs[last].clone() + &(self.energy(&h, v, w) - &alone);
        }
    }

    /// Twice the energy of a displacement gradient H at a point with the volumes v and, for changes of volume, w: isotropic
    /// `w λ (tr H)² + v μ (H : H + H : Hᵀ)`.
    #[inline(always)]
    fn energy(&self, h: &[[T; D]; D], v: &T, w: &T) -> T {
        let mut trace = v.zero();
        for k in 0..D {
            trace = trace + &h[k][k];
        }
        match self.hooke {
            Hooke::Isotropic(moduli) => {
                let mut squares = v.zero();
                for k in 0..D {
                    for l in 0..D {
                        squares = squares.plus_product(&h[k][l], &(h[k][l].clone() + &h[l][k]));
                    }
                }
                let (lambda, mu) = (moduli.lambda.clone() * w, moduli.mu.clone() * v);
                (lambda * &trace.squared()).plus_product(&mu, &squares)
            }
            Hooke::Anisotropic(stiffness) => {
                let stiffness = stiffness.compiled();
                // There are six strains in space and three in the plane, whose places after the third stay empty and
                // are passed over.
                let mut strain = [const { None }; 6];
                for k in 0..D {
                    strain[k] = Some(h[k][k].clone());
                    for l in 0..k {
                        // Voigt's shears are those of engineers, twice the entry of the tensor.
                        strain[voigt(D, k, l)] = Some(h[k][l].clone() + &h[l][k]);
                    }
                }
                let mut density = v.zero();
                for (row, left) in stiffness.entries().chunks_exact(strains(D)).zip(strain.iter().flatten()) {
                    for (entry, right) in row.iter().zip(strain.iter().flatten()) {
                        density = density.plus_product(&(left.clone() * entry), right);
                    }
                }
                let volumetric = (w.clone() - v) * stiffness.lambda();
                (density * v).plus_product(&volumetric, &trace.squared())
            }
        }
    }
}

/// The vectors y and z of two motions with the gradients `n yᵀ` and `n zᵀ`.
pub enum Gradients<T, const D: usize> {
    Same([T; D]),
    Two([T; D], [T; D]),
}

impl<T: Scalar, const D: usize> Gradients<T, D> {
    #[inline(always)]
    fn both(&self) -> (&[T; D], &[T; D]) {
        match self {
            Gradients::Same(y) => (y, y),
            Gradients::Two(y, z) => (y, z),
        }
    }

    /// `y·z`
    #[inline(always)]
    fn product(&self) -> T {
        let (y, z) = self.both();
        dot(y, z)
    }

    /// `(d·y)(d·z)`
    #[inline(always)]
    fn product_along(&self, d: &[T; D]) -> T {
        match self {
            Gradients::Same(y) => dot(d, y).squared(),
            Gradients::Two(y, z) => dot(d, y) * &dot(d, z),
        }
    }
}

/// What the acoustic tensor `A_jl = Σ d_k d_m D_kjml` of a direction has of the products `d_k d_m`: rows by j and l, columns by k
/// and m, each in Voigt's order.
struct Acoustic<T>([[T; 6]; 6]);

impl<T: Scalar> Acoustic<T> {
    #[inline(always)]
    fn of<const D: usize>(stiffness: &Stiffness<T>) -> Acoustic<T> {
        let (entries, s) = (stiffness.entries(), strains(D));
        let entry = |k: usize, j: usize, m: usize, l: usize| &entries[voigt(D, k, j) * s + voigt(D, m, l)];
        let mut parts: [[T; 6]; 6] = entries[0].repeated_rows();
        for j in 0..D {
            for l in 0..=j {
                for k in 0..D {
                    parts[voigt(D, j, l)][k] = entry(k, j, k, l).clone();
                    for m in 0..k {
                        // The part is multiplied by d_k d_m, which is equal to d_m d_k: both are summed once for all
                        // edges.
                        parts[voigt(D, j, l)][voigt(D, k, m)] = entry(k, j, m, l).clone() + entry(m, j, k, l);
                    }
                }
            }
        }
        Acoustic(parts)
    }

    /// That of the direction d, times ‖d‖².
    #[inline(always)]
    fn along<const D: usize>(&self, d: &[T; D]) -> [[T; D]; D] {
        let mut tensor: [[T; D]; D] = d[0].zero().repeated_rows();
        for k in 0..D {
            for m in 0..=k {
                let product = d[k].clone() * &d[m];
                for j in 0..D {
                    for l in 0..=j {
                        let part = &self.0[voigt(D, j, l)][voigt(D, k, m)];
                        tensor[j][l] = tensor[j][l].clone().plus_product(&product, part);
                    }
                }
            }
        }
        for j in 0..D {
            for l in j + 1..D {
                tensor[j][l] = tensor[l][j].clone();
            }
        }
        tensor
    }
}

/// `h²` and `1 − h²`.
#[inline(always)]
pub fn scales<T: Scalar>(zero: &T, higher: Higher) -> (T, T) {
    let h2 = zero.constant(&T::exact(higher.value())).squared();
    (h2.clone(), zero.one() - &h2)
}
