//! One element at large deformation: energy, nodal forces and tangent of a hyperelastic material.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::Geometry;
use crate::material::{Energy, State, Tangent};
use crate::scalar::of_dimension;
use nalgebra::{DMatrix, Matrix3};
use std::array::from_fn;

/// The largest number of steps of the search for the stretch through the thickness that leaves no stress there.
// Newton's steps double the digits, and twenty steps back end the search as well: one that takes more does not end.
const STEPS: usize = 60;

/// Energy, forces and tangent of an element at given positions.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ElementResponse {
    /// The energy `∫ W dV`, in J.
    pub energy: f64,
    /// The gradient of the energy `∂/∂x_a ∫ W dV = ∫ P ∇N_a dV`, `[nodes × dimension]`, N.
    pub force: Vec<f64>,
    /// The tangent `∫ ∇N_a · (∂P/∂F) ∇N_b dV`, `[nodes·dimension × nodes·dimension]`, N/m.
    pub tangent: DMatrix<f64>,
}

impl Geometry {
    /// The response with the nodes at `x`, `[nodes × dimension]`, m, where `self` is the geometry at rest.
    /// `F = Σ_a x_a ∇N_aᵀ`; in the plane F has the stretch through the thickness that the state implies. A cell of a surface or curve has the
    /// coordinates of its space in `x`, `[nodes × space]`, and so have force and tangent. `None` if the energy is not finite.
    ///
    /// The separate quadrature rule of the term λ (div u)² is not used here.
    pub fn respond(&self, energy: &Energy, state: State, x: &[f64]) -> Option<ElementResponse> {
        let (n, d) = (self.nodes, self.dimension);
        if x.len() > n * d {
            return self.respond_in_space(energy, state, x);
        }
        let (mut stored, mut force, mut rows) = (0.0, vec![0.0; n * d], vec![0.0; (n * d).pow(2)]);
        let free = free_axes(state);
        for (grad, v) in self.weighted() {
            let f = deformation(grad, x, d);
            let (w, stress, tangent) = match free {
                [] => energy.respond(&f),
                _ => without_stress(energy, f, free)?,
            };
            // The norm is finite only where every entry is: one test instead of 81.
            if !(w.is_finite() && tangent.norm().is_finite()) {
                return None;
            }
            let v = v * state.thickness();
            stored += v * w;
            add_forces(&stress, grad, v, d, &mut force);
            of_dimension!(d, |D| add_tangent::<D>(&tangent, grad, v, &mut rows));
        }
        Some(ElementResponse { energy: stored, force, tangent: DMatrix::from_row_slice(n * d, n * d, &rows) })
    }

    /// Writes the nodal forces of [`Geometry::respond`] alone into `force`. False if the energy is not finite, or if
    /// less than the share `upright` of the volume (in the plane of the area) is left at a quadrature point.
    pub fn forces(&self, energy: &Energy, state: State, x: &[f64], upright: f64, force: &mut [f64]) -> bool {
        let d = self.dimension;
        if x.len() > self.nodes * d {
            return self.forces_in_space(energy, state, x, force);
        }
        let free = free_axes(state);
        force.fill(0.0);
        for (grad, v) in self.weighted() {
            let f = deformation(grad, x, d);
            // The determinant is tested before the stress, which an energy with a logarithm may not have there.
            if f.determinant() < upright {
                return false;
            }
            let stress = match free {
                [] => Some(energy.stress(&f)),
                _ => without_stress(energy, f, free).map(|(_, stress, _)| stress),
            };
            let Some(stress) = stress.filter(|p| p.iter().all(|entry| entry.is_finite())) else { return false };
            add_forces(&stress, grad, v * state.thickness(), d, force);
        }
        true
    }

    /// Appends the F of each quadrature point with a weight to `f`, with the nodes at `x`, `[nodes × dimension]`, m. False, with
    /// nothing appended, if less than the share `upright` of the volume (in the plane of the area) is left at one.
    pub fn deformations(&self, x: &[f64], upright: f64, f: &mut Vec<Matrix3<f64>>) -> bool {
        let first = f.len();
        f.extend(self.weighted().map(|(grad, _)| deformation(grad, x, self.dimension)));
        let is_upright = f[first..].iter().all(|f| f.determinant() >= upright);
        if !is_upright {
            f.truncate(first);
        }
        is_upright
    }

    /// Writes the nodal forces of the stresses at the points of [`Geometry::deformations`] into `force`. False if they are not finite.
    pub fn forces_of(&self, stresses: &[Matrix3<f64>], state: State, force: &mut [f64]) -> bool {
        force.fill(0.0);
        for (stress, (grad, v)) in stresses.iter().zip(self.weighted()) {
            add_forces(stress, grad, v * state.thickness(), self.dimension, force);
        }
        force.iter().all(|force| force.is_finite())
    }

    /// The gradients of the quadrature points that have a weight, `[nodes × dimension]`, and their volumes.
    pub(super) fn weighted(&self) -> impl Iterator<Item = (&[f64], f64)> {
        let points = self.gradients.chunks_exact(self.nodes * self.dimension).zip(&self.volumes);
        // Points of the volumetric rule alone have no weight in the energy.
        points.map(|(grad, v)| (grad, *v)).filter(|(_, v)| *v != 0.0)
    }
}

/// Adds `v P ∇N_a` for each node.
fn add_forces(stress: &Matrix3<f64>, grad: &[f64], v: f64, d: usize, force: &mut [f64]) {
    for (force, ga) in force.chunks_exact_mut(d).zip(grad.chunks_exact(d)) {
        for (k, force) in force.iter_mut().enumerate() {
            *force += v * (0..d).map(|l| stress[(k, l)] * ga[l]).sum::<f64>();
        }
    }
}

/// Adds `v ∇N_a · (∂P/∂F) ∇N_b` for each pair of nodes to the `rows`, `[nodes·D × nodes·D]`.
fn add_tangent<const D: usize>(tangent: &Tangent, grad: &[f64], v: f64, rows: &mut [f64]) {
    let (gradients, _) = grad.as_chunks::<D>();
    let size = grad.len();
    for (rows, ga) in rows.chunks_exact_mut(D * size).zip(gradients) {
        for (k, row) in rows.chunks_exact_mut(size).enumerate() {
            // ∇N_a · ∂P_k·/∂F, then its product with every ∇N_b.
            let half: [[f64; D]; D] =
                from_fn(|m| from_fn(|s| v * (0..D).map(|l| ga[l] * tangent[(3 * k + l, 3 * m + s)]).sum::<f64>()));
            for (entries, gb) in row.as_chunks_mut::<D>().0.iter_mut().zip(gradients) {
                for m in 0..D {
                    entries[m] += (0..D).map(|l| half[m][l] * gb[l]).sum::<f64>();
                }
            }
        }
    }
}

/// The axes along which the state has no stress.
pub(super) fn free_axes(state: State) -> &'static [usize] {
    match state {
        State::PlaneStress { .. } => &[2],
        State::Rod { .. } => &[1, 2],
        State::Solid | State::PlaneStrain { .. } => &[],
    }
}

impl Geometry {
    /// The least det F over the quadrature points, where `self` is the geometry at rest; in the plane that of the F in
    /// the plane.
    pub fn least_determinant(&self, x: &[f64]) -> f64 {
        let points = self.gradients.chunks_exact(x.len());
        points.map(|grad| deformation(grad, x, self.dimension).determinant()).fold(f64::INFINITY, f64::min)
    }
}

/// `F = Σ_a x_a ∇N_aᵀ`, extended by the identity for planes and rods.
fn deformation(grad: &[f64], x: &[f64], d: usize) -> Matrix3<f64> {
    let mut f = Matrix3::identity();
    // The identity stays in the directions that a plane or a rod does not have.
    (0..d).for_each(|k| f[(k, k)] = 0.0);
    for (x, g) in x.chunks_exact(d).zip(grad.chunks_exact(d)) {
        for k in 0..d {
            for l in 0..d {
                f[(k, l)] += x[k] * g[l];
            }
        }
    }
    f
}

/// The response with stretches along the `free` axes that leave no stress along them, condensed to the other axes. All
/// free stretches are equal.
pub(super) fn without_stress(
    energy: &Energy,
    mut f: Matrix3<f64>,
    free: &[usize],
) -> Option<(f64, Matrix3<f64>, Tangent)> {
    let place = |k: usize| 4 * k;
    let mut step = 1.0;
    for _ in 0..STEPS {
        let (w, stress, tangent) = energy.respond(&f);
        let pull: f64 = free.iter().map(|&k| stress[(k, k)]).sum();
        let stiffness: f64 = free.iter().flat_map(|&k| free.iter().map(move |&l| tangent[(place(k), place(l))])).sum();
        if !(w.is_finite() && stiffness > 0.0) {
            // Too far: go back by half of the last step.
            step /= 2.0;
            free.iter().for_each(|&k| f[(k, k)] = (f[(k, k)] + 1.0) / 2.0);
            if step < 1e-6 {
                return None;
            }
            continue;
        }
        let change = -pull / stiffness;
        // Some fifty rounding errors of the stretch; the condensed tangent is that of no stress.
        let stretch = free.iter().map(|&k| f[(k, k)]).fold(1.0, f64::max);
        if change.abs() <= 1e-14 * stretch {
            // The free stretches follow the others: `C_ab − C_af C_fb/C_ff`, with the sums over the free axes because these are equal.
            let mut condensed = tangent;
            for row in 0..9 {
                for column in 0..9 {
                    let sum = |index: usize| free.iter().map(|&k| tangent[(index, place(k))]).sum::<f64>();
                    condensed[(row, column)] -= sum(row) * sum(column) / stiffness;
                }
            }
            return Some((w, stress, condensed));
        }
        // A stretch stays above zero, where the energy has a value.
        free.iter().for_each(|&k| f[(k, k)] = (f[(k, k)] + change).max(0.1 * f[(k, k)]));
    }
    None
}
