//! The stiffness of one element: its geometry at the quadrature points, the strain energy, and R.

use crate::element::Tabulation;
use crate::material::Moduli;
use nalgebra::DMatrix;
use std::array::from_fn;

/// Where a Jacobian determinant counts as zero: this fraction of the largest that its columns' lengths allow is lost
/// in the rounding of the determinant itself.
const FLAT: f64 = 1e-15;

/// Why an element has no stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// The Jacobian determinant is negative at every quadrature point: the nodes are numbered the other way round.
    Reversed,
    /// The Jacobian changes sign, or vanishes somewhere; the quadrature point with the least determinant.
    Tangled { point: usize, determinant: f64, largest: f64 },
    /// The Jacobian vanishes at every quadrature point: no length, area or volume.
    Flat,
}

/// Gradients of the shape functions and volumes at the quadrature points of one element.
#[derive(Debug, Clone)]
pub struct Geometry {
    pub dimension: usize,
    pub nodes: usize,
    /// `∂N_a/∂x_k`, `[points × nodes × dimension]`, 1/m.
    pub gradients: Vec<f64>,
    /// `w_q |J_q|`, `[points]`, m³ (m² in two dimensions).
    pub volumes: Vec<f64>,
}

impl Geometry {
    /// Room for any element of this tabulation; filled by [`Geometry::set`].
    pub fn new(table: &Tabulation) -> Geometry {
        Geometry {
            dimension: table.dimension,
            nodes: table.nodes,
            gradients: vec![0.0; table.gradients.len()],
            volumes: vec![0.0; table.points()],
        }
    }

    /// Fills in the element whose nodes are at `x`, `[nodes × dimension]`, m.
    ///
    /// # Errors
    /// The element is reversed, tangled or flat.
    pub fn set(&mut self, table: &Tabulation, x: &[f64]) -> Result<(), Fault> {
        // A number of nodes known at compile time unrolls the loops, which for few nodes are all overhead.
        match (self.dimension, self.nodes) {
            (2, 3) => self.set_in::<2>(3, table, x),
            (2, 4) => self.set_in::<2>(4, table, x),
            (3, 4) => self.set_in::<3>(4, table, x),
            (3, 8) => self.set_in::<3>(8, table, x),
            (2, n) => self.set_in::<2>(n, table, x),
            (3, n) => self.set_in::<3>(n, table, x),
            (_, n) => self.set_in::<1>(n, table, x),
        }
    }

    #[inline(always)]
    fn set_in<const D: usize>(&mut self, n: usize, table: &Tabulation, x: &[f64]) -> Result<(), Fault> {
        let x = &x.as_chunks::<D>().0[..n];
        let (mut positive, mut negative) = (0, 0);
        let reference = table.gradients.chunks_exact(n * D);
        let physical = self.gradients.chunks_exact_mut(n * D);
        for (((dn, grad), volume), w) in reference.zip(physical).zip(&mut self.volumes).zip(&table.weights) {
            let (dn, grad) = (&dn.as_chunks::<D>().0[..n], &mut grad.as_chunks_mut::<D>().0[..n]);
            // J_kl = ∂x_k/∂ξ_l = Σ_a x_ak ∂N_a/∂ξ_l
            let entry = |k: usize, l: usize| (0..n).map(|a| x[a][k] * dn[a][l]).sum::<f64>();
            let j: [[f64; D]; D] = from_fn(|k| from_fn(|l| entry(k, l)));
            let (adjugate, determinant) = adjugate(&j);
            let bound: f64 = (0..D).map(|l| (0..D).map(|k| j[k][l] * j[k][l]).sum::<f64>()).product();
            // A product of squares may leave the range of f64 where the determinant does not.
            let flat = if bound > 0.0 && bound.is_finite() {
                determinant * determinant <= FLAT * FLAT * bound
            } else {
                determinant == 0.0
            };
            match determinant {
                _ if flat || determinant.is_nan() => {}
                det if det > 0.0 => positive += 1,
                _ => negative += 1,
            }
            *volume = w * determinant;
            // ∂N_a/∂x_k = Σ_l ∂N_a/∂ξ_l (J⁻¹)_lk
            let inverse = 1.0 / determinant;
            for (ga, dna) in grad.iter_mut().zip(dn) {
                *ga = from_fn(|k| inverse * (0..D).map(|l| dna[l] * adjugate[l][k]).sum::<f64>());
            }
        }
        match (positive, negative, self.volumes.len()) {
            (p, _, all) if p == all => Ok(()),
            (_, n, all) if n == all => Err(Fault::Reversed),
            (0, 0, _) => Err(Fault::Flat),
            _ => Err(self.tangled(table)),
        }
    }

    fn tangled(&self, table: &Tabulation) -> Fault {
        let determinants = || self.volumes.iter().zip(&table.weights).map(|(v, w)| v / w);
        let least = determinants().enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let (point, determinant) = least.unwrap_or((0, 0.0));
        Fault::Tangled { point, determinant, largest: determinants().fold(f64::NEG_INFINITY, f64::max) }
    }

    pub fn points(&self) -> usize {
        self.volumes.len()
    }

    /// Length, area or volume of the element, `Σ_q w_q |J_q|`.
    pub fn content(&self) -> f64 {
        self.volumes.iter().sum()
    }

    /// `∫ ∂N_a/∂x_k dV`, `[nodes × dimension]`: the gradient of the element's content with respect to its nodes.
    pub fn content_gradient(&self) -> Vec<f64> {
        let size = self.nodes * self.dimension;
        let mut gradient = vec![0.0; size];
        for (grad, v) in self.gradients.chunks_exact(size).zip(&self.volumes) {
            gradient.iter_mut().zip(grad).for_each(|(s, g)| *s += v * g);
        }
        gradient
    }

    /// `uᵀ R u`, twice the strain energy (J) of the nodal displacements `u`, `[nodes × dimension]`, without forming R:
    /// `∫ λ (div u)² + μ (∇u : ∇u + ∇u : ∇uᵀ) dV`.
    pub fn energy(&self, moduli: Moduli, u: &[f64]) -> f64 {
        match self.dimension {
            2 => self.energy_in::<2>(moduli, u),
            3 => self.energy_in::<3>(moduli, u),
            _ => self.energy_in::<1>(moduli, u),
        }
    }

    fn energy_in<const D: usize>(&self, Moduli { lambda, mu }: Moduli, u: &[f64]) -> f64 {
        let u = u.as_chunks::<D>().0;
        let mut energy = 0.0;
        for (grad, v) in self.gradients.chunks_exact(self.nodes * D).zip(&self.volumes) {
            let entry =
                |k: usize, l: usize| u.iter().zip(grad.as_chunks::<D>().0).map(|(ua, ga)| ua[k] * ga[l]).sum::<f64>();
            let h: [[f64; D]; D] = from_fn(|k| from_fn(|l| entry(k, l)));
            let (mut trace, mut squares) = (0.0, 0.0);
            for k in 0..D {
                trace += h[k][k];
                for l in 0..D {
                    squares += h[k][l] * (h[k][l] + h[l][k]);
                }
            }
            energy += v * (lambda * trace * trace + mu * squares);
        }
        energy
    }

    /// `R = ∫ Bᵀ D B dV` of an isotropic material, `[nodes·dimension × nodes·dimension]`, N/m:
    /// `R_ab = ∫ λ ∇N_a ∇N_bᵀ + μ (∇N_b ∇N_aᵀ + ∇N_a·∇N_b I) dV`, the same matrix without the products with zeros.
    /// Natsupakpong and Çavuşoğlu (2010), (13).
    pub fn stiffness(&self, Moduli { lambda, mu }: Moduli) -> DMatrix<f64> {
        let (n, d) = (self.nodes, self.dimension);
        let mut r = DMatrix::zeros(n * d, n * d);
        for (grad, v) in self.gradients.chunks_exact(n * d).zip(&self.volumes) {
            for a in 0..n {
                for b in 0..=a {
                    let (ga, gb) = (&grad[a * d..(a + 1) * d], &grad[b * d..(b + 1) * d]);
                    let dot: f64 = ga.iter().zip(gb).map(|(x, y)| x * y).sum();
                    for k in 0..d {
                        for l in 0..d {
                            let diagonal = if k == l { mu * dot } else { 0.0 };
                            r[(a * d + k, b * d + l)] += v * (lambda * ga[k] * gb[l] + mu * gb[k] * ga[l] + diagonal);
                        }
                    }
                }
            }
        }
        r.fill_upper_triangle_with_lower_triangle();
        r
    }
}

/// Calls `visit(cell, x, geometry)` for every cell: `connectivity` is `[cells × nodes]` into `points`,
/// `[points × dimension]`, m; `x` the positions of the cell's nodes.
///
/// # Errors
/// The first cell that is reversed, tangled or flat, counted from 0.
pub fn each_cell(
    table: &Tabulation,
    points: &[f64],
    connectivity: &[usize],
    mut visit: impl FnMut(usize, &[f64], &Geometry),
) -> Result<(), (usize, Fault)> {
    let mut geometry = Geometry::new(table);
    let mut x = vec![0.0; table.nodes * table.dimension];
    for (cell, nodes) in connectivity.chunks_exact(table.nodes).enumerate() {
        gather(points, table.dimension, nodes, &mut x);
        geometry.set(table, &x).map_err(|fault| (cell, fault))?;
        visit(cell, &x, &geometry);
    }
    Ok(())
}

/// Copies the coordinates of `nodes` into `x`, `[nodes × dimension]`.
pub fn gather(points: &[f64], dimension: usize, nodes: &[usize], x: &mut [f64]) {
    match dimension {
        2 => gather_in::<2>(points, nodes, x),
        3 => gather_in::<3>(points, nodes, x),
        _ => gather_in::<1>(points, nodes, x),
    }
}

fn gather_in<const D: usize>(points: &[f64], nodes: &[usize], x: &mut [f64]) {
    let points = points.as_chunks::<D>().0;
    x.as_chunks_mut::<D>().0.iter_mut().zip(nodes).for_each(|(x, &node)| *x = points[node]);
}

/// `adj(J)` and `det J`, so that `J⁻¹ = adj(J)/det J`.
#[inline(always)]
fn adjugate<const D: usize>(j: &[[f64; D]; D]) -> ([[f64; D]; D], f64) {
    let mut a = [[0.0; D]; D];
    let minor = |p: usize, q: usize, r: usize, s: usize| j[p][r] * j[q][s] - j[p][s] * j[q][r];
    match D {
        1 => a[0][0] = 1.0,
        2 => (a[0][0], a[0][1], a[1][0], a[1][1]) = (j[1][1], -j[0][1], -j[1][0], j[0][0]),
        _ => {
            (a[0][0], a[1][0], a[2][0]) = (minor(1, 2, 1, 2), minor(1, 2, 2, 0), minor(1, 2, 0, 1));
            (a[0][1], a[1][1], a[2][1]) = (minor(2, 0, 1, 2), minor(2, 0, 2, 0), minor(2, 0, 0, 1));
            (a[0][2], a[1][2], a[2][2]) = (minor(0, 1, 1, 2), minor(0, 1, 2, 0), minor(0, 1, 0, 1));
        }
    }
    let determinant = (0..D).map(|l| j[0][l] * a[l][0]).sum();
    (a, determinant)
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Fault::Reversed => write!(f, "its nodes are numbered the other way round (negative Jacobian everywhere)"),
            Fault::Tangled { point, determinant, largest } => write!(
                f,
                "the element is tangled: its Jacobian determinant goes from {largest:.3e} down to {determinant:.3e} at \
                 quadrature point {point}"
            ),
            Fault::Flat => write!(f, "the element has no volume (its Jacobian vanishes)"),
        }
    }
}
