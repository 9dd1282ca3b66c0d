//! Cells of surfaces and curves at large deformation in a space of more dimensions: membranes and rods.
//!
//! With orthonormal vectors `a_k` along the deformed cell, `F̂ = Σ_a x_a ∇N_aᵀ = Σ_k a_k (F)_k` has the in-plane part F, of which the energy is a
//! function alone: it does not change if the cell is turned. So is the stress `P̂ = Σ_k a_k (P)_k`. A motion out of the cell changes
//! `C = F̂ᵀF̂` to second order only and meets the stress `S = F⁻¹P`.
//!
//! Theory: page *Stiffness and the reduced space* of the book.

use super::Geometry;
use super::large::{ElementResponse, free_axes, without_stress};
use crate::material::{Energy, State, Tangent};
use nalgebra::{DMatrix, Matrix3, Vector3};

/// A cell whose tangents are closer to a common line, relative to their lengths, has no plane. What is left of a
/// tangent then is the rounding of its projection.
const FLAT: f64 = 1e-12;

/// A deformed cell at a quadrature point.
struct Placed {
    /// The vectors along the cell, `[dimension]`; entries beyond the space are zero.
    along: Vec<Vector3<f64>>,
    /// The in-plane deformation gradient, extended by the identity.
    f: Matrix3<f64>,
}

impl Placed {
    /// The place with the nodes at `x`, `[nodes × space]`, m; `None` if the cell has no tangents there.
    fn of(grad: &[f64], x: &[f64], d: usize, space: usize) -> Option<Placed> {
        let mut tangents = vec![Vector3::zeros(); d];
        for (x, g) in x.chunks_exact(space).zip(grad.chunks_exact(d)) {
            for (tangent, g) in tangents.iter_mut().zip(g) {
                (0..space).for_each(|k| tangent[k] += x[k] * g);
            }
        }
        let mut along: Vec<Vector3<f64>> = Vec::with_capacity(d);
        for tangent in &tangents {
            let mut rest = *tangent;
            // Gram's and Schmidt's method keeps the first vector along the first
            // tangent: F is an upper triangle, whatever way the cell is turned.
            along.iter().for_each(|a| rest -= a.dot(&rest) * a);
            let length = rest.norm();
            if !(length > FLAT * tangent.norm()) {
                return None;
            }
            along.push(rest / length);
        }
        let mut f = Matrix3::identity();
        for (k, a) in along.iter().enumerate() {
            tangents.iter().enumerate().for_each(|(l, tangent)| f[(k, l)] = a.dot(tangent));
        }
        Some(Placed { along, f })
    }

    /// Energy, stress and tangent in the cell; `None` if they are not finite.
    fn respond(&self, energy: &Energy, state: State) -> Option<(f64, Matrix3<f64>, Tangent)> {
        let (w, stress, tangent) = match free_axes(state) {
            [] => energy.respond(&self.f),
            free => without_stress(energy, self.f, free)?,
        };
        (w.is_finite() && tangent.norm().is_finite()).then_some((w, stress, tangent))
    }
}

impl Geometry {
    /// [`Geometry::respond`] of a cell of fewer dimensions than its space, with the nodes at `x`, `[nodes × space]`, m.
    pub(super) fn respond_in_space(&self, energy: &Energy, state: State, x: &[f64]) -> Option<ElementResponse> {
        let (n, d, space) = (self.nodes, self.dimension, x.len() / self.nodes);
        let mut response =
            ElementResponse { energy: 0.0, force: vec![0.0; n * space], tangent: DMatrix::zeros(n * space, n * space) };
        for (grad, v) in self.weighted() {
            let placed = Placed::of(grad, x, d, space)?;
            let (w, stress, tangent) = placed.respond(energy, state)?;
            let v = v * state.thickness();
            response.energy += v * w;
            // This stress resists motions out of the cell, which the in-plane energy sees to second order alone.
            let second = placed.f.try_inverse()? * stress;
            for (a, ga) in grad.chunks_exact(d).enumerate() {
                let pull: Vec<f64> = (0..d).map(|k| (0..d).map(|l| stress[(k, l)] * ga[l]).sum()).collect();
                for (i, force) in response.force[a * space..][..space].iter_mut().enumerate() {
                    *force += v * placed.along.iter().zip(&pull).map(|(along, p)| along[i] * p).sum::<f64>();
                }
                for (b, gb) in grad.chunks_exact(d).enumerate() {
                    let pairs = || (0..d).flat_map(|l| (0..d).map(move |q| (l, q, ga[l] * gb[q])));
                    let out: f64 = pairs().map(|(l, q, g)| g * second[(l, q)]).sum();
                    let mut block = Matrix3::from_diagonal_element(out);
                    for (k, own) in placed.along.iter().enumerate() {
                        for (m, other) in placed.along.iter().enumerate() {
                            let inside: f64 = pairs().map(|(l, q, g)| g * tangent[(3 * k + l, 3 * m + q)]).sum();
                            // The term of `second` is on the whole diagonal; along the cell the in-plane tangent has it already.
                            let entry = if k == m { inside - out } else { inside };
                            for (i, j) in (0..space).flat_map(|i| (0..space).map(move |j| (i, j))) {
                                block[(i, j)] += entry * own[i] * other[j];
                            }
                        }
                    }
                    for (i, j) in (0..space).flat_map(|i| (0..space).map(move |j| (i, j))) {
                        response.tangent[(a * space + i, b * space + j)] += v * block[(i, j)];
                    }
                }
            }
        }
        Some(response)
    }

    /// [`Geometry::forces`] of a cell of fewer dimensions than its space.
    pub(super) fn forces_in_space(&self, energy: &Energy, state: State, x: &[f64], force: &mut [f64]) -> bool {
        let (d, space) = (self.dimension, x.len() / self.nodes);
        force.fill(0.0);
        // The in-plane part of F has a positive determinant by construction, so that no shape is inverted.
        for (grad, v) in self.weighted() {
            let Some(placed) = Placed::of(grad, x, d, space) else { return false };
            let stress = match free_axes(state) {
                [] => Some(energy.stress(&placed.f)),
                free => without_stress(energy, placed.f, free).map(|(_, stress, _)| stress),
            };
            let Some(stress) = stress.filter(|p| p.iter().all(|entry| entry.is_finite())) else { return false };
            let v = v * state.thickness();
            for (force, ga) in force.chunks_exact_mut(space).zip(grad.chunks_exact(d)) {
                for (k, along) in placed.along.iter().enumerate() {
                    let pull: f64 = (0..d).map(|l| stress[(k, l)] * ga[l]).sum();
                    force.iter_mut().zip(along).for_each(|(force, a)| *force += v * a * pull);
                }
            }
        }
        true
    }

    /// How far the nodes at rest, `[nodes × space]`, m, are from a flat cell: the largest strain of the flat one in their place.
    pub fn bend(&self, x: &[f64]) -> f64 {
        let (d, space) = (self.dimension, x.len() / self.nodes);
        let strain =
            // A cell without tangents is bent as much as one can be.
            |(grad, _)| Placed::of(grad, x, d, space).map_or(1.0, |placed| (placed.f - Matrix3::identity()).norm());
        if space == d { 0.0 } else { self.weighted().map(strain).fold(0.0, f64::max) }
    }
}
