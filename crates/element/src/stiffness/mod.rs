//! The stiffness of one element: its geometry at the quadrature points, and `R = ∫ Bᵀ D B dV`.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

mod condensed;
mod embedded;
mod fault;
mod hyperelastic;
mod large;
mod placement;
mod sound;

pub use fault::Fault;
pub use hyperelastic::{EnergyFunction, Hyperelastic, StressFunction};
pub use large::ElementResponse;
pub use placement::{Placement, gather, gathered};

use crate::element::Tabulation;
use crate::material::{Hooke, Moduli, Stiffness, strains, voigt};
use crate::scalar::{Scalar, adjugate, dot, multiple, of_dimension, plus_multiple, vectorized, zeros};
use nalgebra::DMatrix;

/// Gradients of the shape functions and volumes at the quadrature points, of one element or of one per SIMD lane.
#[derive(Debug, Clone)]
pub struct Geometry<T = f64> {
    /// The number of coordinates of a node.
    pub dimension: usize,
    /// The number of nodes.
    pub nodes: usize,
    /// The gradients `∂N_a/∂x_k`, `[points × nodes × dimension]`, 1/m.
    pub gradients: Vec<T>,
    /// The volumes `w_q |J_q|` of the points, `[points]`, m³ (m² in two dimensions).
    pub volumes: Vec<T>,
    /// The volumes for the term λ (div u)²; empty if it has the same quadrature.
    pub volumetric: Vec<T>,
    /// The gradients of functions that are condensed, `[points × modes × dimension]`, 1/m.
    pub modes: Vec<T>,
    /// The number of functions that are condensed.
    pub mode_count: usize,
}

impl<T: Scalar> Geometry<T> {
    /// Memory for any element of this tabulation, to be filled by [`Geometry::update`]; `any` selects the kind of
    /// number.
    pub fn like(any: &T, table: &Tabulation<T::Constant>) -> Geometry<T> {
        Geometry {
            dimension: table.dimension,
            nodes: table.nodes,
            gradients: vec![any.zero(); table.gradients.len()],
            volumes: vec![any.zero(); table.points()],
            volumetric: vec![any.zero(); table.volumetric.len()],
            modes: vec![any.zero(); table.modes.as_ref().map_or(0, |modes| modes.gradients.len())],
            mode_count: table.modes.as_ref().map_or(0, |modes| modes.count()),
        }
    }

    /// Fills in the element whose nodes are at `x`, `[nodes × dimension]`, m. Returns false if a Jacobian determinant
    /// is not safely positive, see [`Scalar::delicate`]; [`Geometry::set`] then finds the fault.
    pub fn update(&mut self, table: &Tabulation<T::Constant>, x: &[T]) -> bool {
        let positive = self.update_nodes(table, x);
        if self.is_condensed() {
            vectorized!(x[0], of_dimension!(table.dimension, |D| self.update_modes::<D>(table, x)));
        }
        positive
    }

    /// [`Geometry::update`] of an element without condensed functions.
    pub fn update_nodes(&mut self, table: &Tabulation<T::Constant>, x: &[T]) -> bool {
        let n = self.nodes;
        vectorized!(x[0], of_dimension!(table.dimension, |D| self.update_in::<D>(n, table, x)))
    }

    /// [`Geometry::update_nodes`] in D dimensions, as part of a kernel.
    #[inline(always)]
    pub fn update_in<const D: usize>(&mut self, n: usize, table: &Tabulation<T::Constant>, x: &[T]) -> bool {
        let x = &x.as_chunks::<D>().0[..n];
        let mut positive = true;
        // Squares are compared, because Hadamard's bound has a root.
        let flat = T::exact(T::delicate().powi(2));
        let reference = table.gradients.chunks_exact(n * D);
        let physical = self.gradients.chunks_exact_mut(n * D);
        for (q, (((dn, grad), volume), w)) in
            reference.zip(physical).zip(&mut self.volumes).zip(&table.weights).enumerate()
        {
            let (dn, grad) = (&dn.as_chunks::<D>().0[..n], &mut grad.as_chunks_mut::<D>().0[..n]);
            let j = jacobian(x, dn);
            let (adjugate, determinant) = adjugate(&j);
            let least = squared_bound(&j).scaled(&flat);
            // All points are worked out in any case: a branch for each would cost more, and lanes differ.
            positive &= determinant.exceeds(&determinant.zero()) && determinant.clone().squared().exceeds(&least);
            // ∂N_a/∂x_k = Σ_l ∂N_a/∂ξ_l (J⁻¹)_lk
            let inverse = multiple(&(determinant.one() / &determinant), &adjugate);
            if let (Some(volume), Some(w)) = (self.volumetric.get_mut(q), table.volumetric.get(q)) {
                *volume = determinant.clone().scaled(w);
            }
            *volume = determinant.scaled(w);
            for (ga, dna) in grad.iter_mut().zip(dn) {
                for k in 0..D {
                    ga[k] = inverse[0][k].clone().scaled(&dna[0]);
                    for l in 1..D {
                        ga[k] = ga[k].clone().plus_product(&inverse[l][k], &inverse[l][k].constant(&dna[l]));
                    }
                }
            }
        }
        positive
    }

    /// The number of quadrature points.
    pub fn points(&self) -> usize {
        self.volumes.len()
    }

    /// For every quadrature point `∂N_a/∂x_k`, its volume, and its volume for the term λ (div u)².
    #[inline(always)]
    pub fn each_point(&self) -> impl Iterator<Item = (&[T], &T, &T)> {
        let volumetric = if self.volumetric.is_empty() { &self.volumes } else { &self.volumetric };
        let gradients = self.gradients.chunks_exact(self.nodes * self.dimension);
        gradients.zip(&self.volumes).zip(volumetric).map(|((grad, v), w)| (grad, v, w))
    }

    /// Length, area or volume of the element, `Σ_q w_q |J_q|`.
    #[inline(always)]
    pub fn content(&self) -> T {
        let mut sum = self.volumes[0].clone();
        for v in &self.volumes[1..] {
            sum = sum + v;
        }
        sum
    }

    /// `∫ ∂N_a/∂x_k dV`, `[nodes × dimension]`: the gradient of the content of the element in the positions of its
    /// nodes.
    #[inline(always)]
    pub fn content_gradient(&self) -> Vec<T> {
        let size = self.nodes * self.dimension;
        let mut gradient = vec![self.volumes[0].zero(); size];
        for (grad, v) in self.gradients.chunks_exact(size).zip(&self.volumes) {
            for (sum, g) in gradient.iter_mut().zip(grad) {
                *sum = sum.clone().plus_product(v, g);
            }
        }
        gradient
    }
}

impl Geometry {
    /// The content that a spring at quadrature point q measures: the volume of the point or, if that is zero, its
    /// volume in the term λ (div u)².
    pub fn point_content(&self, q: usize) -> f64 {
        match self.volumes[q] {
            0.0 => self.volumetric.get(q).copied().unwrap_or(0.0),
            volume => volume,
        }
    }

    /// The gradient `w_q |J_q| ∇N_a` of that content in the positions of the nodes, `[nodes × dimension]`.
    pub fn point_content_gradient(&self, q: usize) -> Vec<f64> {
        let size = self.nodes * self.dimension;
        let volume = self.point_content(q);
        self.gradients[q * size..(q + 1) * size].iter().map(|g| volume * g).collect()
    }

    /// Memory for any element of this tabulation, to be filled by [`Geometry::set`].
    pub fn new(table: &Tabulation) -> Geometry {
        Geometry::like(&0.0, table)
    }

    /// Fills in the element whose nodes are at `x`, `[nodes × dimension]`, m.
    ///
    /// # Errors
    /// The element is reversed, tangled or flat.
    pub fn set(&mut self, table: &Tabulation, x: &[f64]) -> Result<(), Fault> {
        if self.update(table, x) {
            return Ok(());
        }
        of_dimension!(self.dimension, |D| self.fault::<D>(table, x))
    }

    /// The least `det J/Π ‖J_l‖` over the quadrature points of the element with nodes at `x`, with J_l the columns of
    /// J: 1 for right angles, 0 for no volume, negative if the element is inverted.
    pub fn quality(table: &Tabulation, x: &[f64]) -> f64 {
        of_dimension!(table.dimension, |D| quality::<D>(table, x))
    }

    /// The fault of an element whose Jacobian is not safely positive; none if only the bound has overflowed.
    fn fault<const D: usize>(&self, table: &Tabulation, x: &[f64]) -> Result<(), Fault> {
        let (mut positive, mut negative) = (0, 0);
        for dn in table.gradients.chunks_exact(table.nodes * D) {
            let j = jacobian(x.as_chunks::<D>().0, dn.as_chunks::<D>().0);
            let (_, determinant) = adjugate(&j);
            let bound = squared_bound(&j);
            // Products of lengths beyond 1e51 overflow, and the test by them says nothing.
            let flat = if bound > 0.0 && bound.is_finite() {
                determinant * determinant <= f64::delicate().powi(2) * bound
            } else {
                determinant == 0.0
            };
            match determinant {
                _ if flat || determinant.is_nan() => {}
                det if det > 0.0 => positive += 1,
                _ => negative += 1,
            }
        }
        match (positive, negative, table.points()) {
            (p, _, all) if p == all => Ok(()),
            (_, n, all) if n == all => Err(Fault::Reversed),
            (0, 0, _) => Err(Fault::Flat),
            _ => Err(self.tangled(table)),
        }
    }

    fn tangled(&self, table: &Tabulation) -> Fault {
        let at = |q: usize| {
            // A point of the volumetric rule alone has no volume in the other.
            let w = table.weights[q];
            if w == 0.0 { self.volumetric[q] / table.volumetric[q] } else { self.volumes[q] / w }
        };
        let determinants = || (0..table.points()).map(at);
        let least = determinants().enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let (point, determinant) = least.unwrap_or((0, 0.0));
        Fault::Tangled { point, determinant, largest: determinants().fold(f64::NEG_INFINITY, f64::max) }
    }

    /// `R = ∫ Bᵀ D B dV`, `[nodes·dimension × nodes·dimension]`, N/m; of an isotropic material
    /// `R_ab = ∫ λ ∇N_a ∇N_bᵀ + μ (∇N_b ∇N_aᵀ + ∇N_a·∇N_b I) dV`, the same matrix without the products with zeros.
    /// Natsupakpong and Çavuşoğlu (2010), (13).
    pub fn stiffness(&self, hooke: impl Into<Hooke>) -> DMatrix<f64> {
        self.stiffness_of(hooke.into())
    }

    /// [`Self::stiffness`], without parameters of type: compiled here, where code is optimised, and not with each caller.
    fn stiffness_of(&self, hooke: Hooke) -> DMatrix<f64> {
        let (n, d) = (self.nodes, self.dimension);
        let size = n * d;
        let Moduli { lambda, mu } = match hooke {
            hooke @ Hooke::Anisotropic(_) => return DMatrix::from_vec(size, size, self.entries(&hooke)),
            hooke if self.is_condensed() => return DMatrix::from_vec(size, size, self.entries(&hooke)),
            Hooke::Isotropic(moduli) => moduli,
        };
        let mut r = DMatrix::zeros(size, size);
        for (grad, v, w) in self.each_point() {
            let (lambda, mu) = (w * lambda, v * mu);
            for a in 0..n {
                for b in 0..=a {
                    let (ga, gb) = (&grad[a * d..(a + 1) * d], &grad[b * d..(b + 1) * d]);
                    let dot: f64 = ga.iter().zip(gb).map(|(x, y)| x * y).sum();
                    for k in 0..d {
                        for l in 0..d {
                            let diagonal = if k == l { mu * dot } else { 0.0 };
                            r[(a * d + k, b * d + l)] += lambda * ga[k] * gb[l] + mu * gb[k] * ga[l] + diagonal;
                        }
                    }
                }
            }
        }
        r.fill_upper_triangle_with_lower_triangle();
        r
    }
}

/// Adds `v B_aᵀ D B_b + (w − v) λ g_a g_bᵀ` for all b ≤ a to r, `[nodes·D × nodes·D]`, with D and the λ of the nearest isotropic law;
/// blocks above the diagonal stay. v is the volume of the point, w that for changes of volume.
#[inline(always)]
fn add_anisotropic<T: Scalar, const D: usize>(r: &mut [T], g: &[[T; D]], stiffness: &Stiffness<T>, v: &T, w: &T) {
    let (zero, size, s) = (v.zero(), g.len() * D, strains(D));
    let entries = stiffness.entries();
    let volumetric = (w.clone() - v) * stiffness.lambda();
    for (a, ga) in g.iter().enumerate() {
        // v D B_a, by the direction of the node and the strain.
        let mut stress: [[T; 6]; D] = zero.repeated_rows();
        for k in 0..D {
            for strain in 0..s {
                let mut sum = zero.clone();
                for j in 0..D {
                    sum = sum.plus_product(&ga[j], &entries[voigt(D, k, j) * s + strain]);
                }
                stress[k][strain] = sum * v;
            }
        }
        for (b, gb) in g[..a + 1].iter().enumerate() {
            for k in 0..D {
                let across = volumetric.clone() * &ga[k];
                for l in 0..D {
                    let place = (a * D + k) * size + b * D + l;
                    let mut entry = r[place].clone().plus_product(&across, &gb[l]);
                    for m in 0..D {
                        entry = entry.plus_product(&stress[k][voigt(D, l, m)], &gb[m]);
                    }
                    r[place] = entry;
                }
            }
        }
    }
}

/// Adds `v Bᵀ D B` of a quadrature point with the gradients g, and the volumes v and, for the term λ (div u)², w, to the blocks b ≤ a of r,
/// `[nodes·D × nodes·D]`.
#[inline(always)]
pub fn add_stiffness<T: Scalar, const D: usize>(r: &mut [T], g: &[[T; D]], hooke: &Hooke<T>, v: &T, w: &T) {
    match hooke {
        Hooke::Isotropic(Moduli { lambda, mu }) => {
            add_isotropic(r, g, &(w.clone() * lambda), &(v.clone() * mu));
        }
        Hooke::Anisotropic(stiffness) => add_anisotropic(r, g, stiffness, v, w),
    }
}

/// Adds `λ g_a g_bᵀ + μ (g_b g_aᵀ + g_a·g_b I)` for all b ≤ a to r, `[nodes·D × nodes·D]`; blocks above the diagonal stay.
#[inline(always)]
fn add_isotropic<T: Scalar, const D: usize>(r: &mut [T], g: &[[T; D]], lambda: &T, mu: &T) {
    let (zero, size) = (lambda.zero(), g.len() * D);
    for (a, ga) in g.iter().enumerate() {
        let (lambda_a, mu_a): ([T; D], [T; D]) =
            (plus_multiple(&zeros(&zero), lambda, ga), plus_multiple(&zeros(&zero), mu, ga));
        for (b, gb) in g[..a + 1].iter().enumerate() {
            let diagonal = dot(&mu_a, gb);
            for k in 0..D {
                let row = &mut r[(a * D + k) * size + b * D..(a * D + k) * size + b * D + D];
                for l in 0..D {
                    let entry = row[l].clone().plus_product(&lambda_a[k], &gb[l]);
                    row[l] = entry.plus_product(&mu_a[l], &gb[k]);
                }
                row[k] = row[k].clone() + &diagonal;
            }
        }
    }
}

/// Calls `visit(cell, x, geometry)` for every cell. `connectivity` is `[cells × nodes]` into `points`,
/// `[points × space]`, m; `x` holds the positions of the nodes of the cell, in its own plane or line if its dimension
/// is less than that of its space.
///
/// # Errors
/// A cell is reversed, tangled or flat. The error gives the first such cell, counted from 0.
pub fn each_cell(
    table: &Tabulation,
    points: &[f64],
    connectivity: &[usize],
    mut visit: impl FnMut(usize, &[f64], &Geometry),
) -> Result<(), (usize, Fault)> {
    let mut geometry = Geometry::new(table);
    let mut placement = Placement::new(table);
    let mut x = vec![0.0; table.nodes * table.dimension];
    for (cell, nodes) in connectivity.chunks_exact(table.nodes).enumerate() {
        let placed = placement.place(table, points, nodes, &mut x);
        placed.and_then(|()| geometry.set(table, &x)).map_err(|fault| (cell, fault))?;
        visit(cell, &x, &geometry);
    }
    Ok(())
}

/// The Jacobian `J_kl = ∂x_k/∂ξ_l = Σ_a x_ak ∂N_a/∂ξ_l`.
#[inline(always)]
fn jacobian<T: Scalar, const D: usize>(x: &[[T; D]], dn: &[[T::Constant; D]]) -> [[T; D]; D] {
    let zero = x[0][0].zero();
    let mut j: [[T; D]; D] = zero.repeated_rows();
    for k in 0..D {
        for l in 0..D {
            j[k][l] = x[0][k].clone().scaled(&dn[0][l]);
            for a in 1..x.len() {
                j[k][l] = j[k][l].clone().plus_product(&x[a][k], &zero.constant(&dn[a][l]));
            }
        }
    }
    j
}

fn quality<const D: usize>(table: &Tabulation, x: &[f64]) -> f64 {
    let of = |dn: &[f64]| {
        let j = jacobian(x.as_chunks::<D>().0, dn.as_chunks::<D>().0);
        let (_, determinant) = adjugate(&j);
        // Divided length by length, because the product of the lengths may overflow.
        (0..D).fold(determinant, |ratio, l| {
            let length = (0..D).map(|k| j[k][l] * j[k][l]).sum::<f64>().sqrt();
            if length > 0.0 { ratio / length } else { 0.0 }
        })
    };
    table.gradients.chunks_exact(table.nodes * D).map(of).fold(f64::INFINITY, f64::min)
}

/// The product of the squared lengths of the columns, which bounds `det² J` (Hadamard).
#[inline(always)]
fn squared_bound<T: Scalar, const D: usize>(j: &[[T; D]; D]) -> T {
    let mut bound = j[0][0].one();
    for l in 0..D {
        let mut square = j[0][l].clone().squared();
        for k in 1..D {
            square = square.plus_product(&j[k][l], &j[k][l]);
        }
        bound = bound * &square;
    }
    bound
}
