//! The forces on the points at rest, and the least correction that removes them.

use super::contents::Contents;
use super::edges::Edges;
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::Mesh;
use crate::model::{Entries, Network, Support};
use crate::solve::System;
use faer::sparse::Triplet;

/// The largest force on a point at rest that is accepted, relative to the largest force of a spring.
// It moves a point by about this share of the length of an edge. Reports print fewer digits of a displacement.
const TOLERANCE: f64 = 1e-10;
/// Corrections end when the largest force is below this share.
// The force on a point is a sum over its springs, some tens, each rounded by 1.1e-16.
const FOUND: f64 = 1e-14;
/// The largest number of corrections.
// Each correction gains several of the sixteen digits (see [`RAISED`]). Corrections end when one gains none.
const ROUNDS: usize = 12;
/// The shift of the diagonal, relative to its mean. The equations are singular, because rigid motions cause no force.
/// It is beyond the rounding of the factor, and small enough that each correction gains several digits of the other
/// forces.
const RAISED: f64 = 1e-9;

/// The springs whose forces at rest have to be in equilibrium.
pub(super) struct RestForces<'a> {
    mesh: &'a Mesh,
    network: &'a Network,
    edges: &'a Edges,
    contents: &'a Contents,
    /// The forces of the springs that do not change, `[points × dimension]`, N.
    fixed: Vec<f64>,
}

impl<'a> RestForces<'a> {
    /// Sums the forces at rest of the springs that do not change. The network's springs on content that are in `contents` may change their
    /// tension.
    pub fn new(mesh: &'a Mesh, network: &'a Network, edges: &'a Edges, contents: &'a Contents) -> RestForces<'a> {
        let d = mesh.dimension;
        let mut fixed = vec![0.0; mesh.points.len()];
        let mut free = contents.places.iter().peekable();
        for (place, spring) in network.others.iter().enumerate() {
            if free.next_if_eq(&&place).is_some() {
                continue;
            }
            let x = super::contents::positions(mesh, spring);
            let tension = spring.tension(spring.measure.value(&x, d));
            if tension != 0.0 {
                add(&mut fixed, &spring.points, &spring.measure.gradient(&x, d), tension);
            }
        }
        RestForces { mesh, network, edges, contents, fixed }
    }

    /// The gradient of the energy in the positions at rest, `[points × dimension]`, N, with these constants and these
    /// tensions of the springs on content.
    fn forces(&self, constants: &[f64], tensions: &[f64]) -> Vec<f64> {
        let mut forces = self.fixed.clone();
        let d = self.mesh.dimension;
        for (edge, k) in constants.iter().enumerate().filter(|(_, k)| **k != 0.0) {
            let [i, j] = self.edges.pairs[edge];
            for (axis, r) in self.edges.vector(self.mesh, edge).iter().enumerate() {
                forces[i * d + axis] -= k * r;
                forces[j * d + axis] += k * r;
            }
        }
        for (content, tension) in tensions.iter().enumerate() {
            add(&mut forces, self.points(content), &self.contents.gradients[content], *tension);
        }
        forces
    }

    /// The largest force on a point in one direction, relative to the largest force of a spring.
    fn share(&self, forces: &[f64], constants: &[f64]) -> f64 {
        // Springs of no rest length pull with k ℓ.
        let largest = constants.iter().zip(&self.edges.lengths).map(|(k, l)| k.abs() * l).fold(0.0, f64::max);
        forces.iter().fold(0.0f64, |a, f| a.max(f.abs())) / largest
    }

    /// Changes positive constants, and tensions, by relative amounts with the least sum of squares such that no point
    /// feels a force at rest. Returns the remaining force, relative to the largest force of a spring.
    ///
    /// # Errors
    /// A constant becomes negative, or a force remains.
    pub fn correct(&self, constants: &mut [f64], tensions: &mut [f64]) -> Result<f64> {
        let d = self.mesh.dimension;
        let mut forces = self.forces(constants, tensions);
        let mut left = self.share(&forces, constants);
        if left > FOUND {
            let squares: Vec<f64> = constants.iter().map(|k| k * k).collect();
            let tension_squares: Vec<f64> = tensions.iter().map(|t| t * t).collect();
            let system = System::new(&self.normal(&squares, &tension_squares), &Support::free(self.mesh))?
                .placed(&self.mesh.points, d);
            let factor = system.cholesky()?.ok_or_else(|| unbalanced("equations of the balance that are singular"))?;
            for _ in 0..ROUNDS {
                let mut lambda = forces.clone();
                factor.solve(&mut lambda);
                let (mut nearer, mut tighter) = (constants.to_vec(), tensions.to_vec());
                // The least relative change is one by `k²`: springs that are zero stay zero.
                for (edge, k) in nearer.iter_mut().enumerate().filter(|(_, k)| **k > 0.0) {
                    let [i, j] = self.edges.pairs[edge];
                    let r = self.edges.vector(self.mesh, edge);
                    let along: f64 = (0..d).map(|axis| r[axis] * (lambda[j * d + axis] - lambda[i * d + axis])).sum();
                    *k -= squares[edge] * along;
                }
                for (content, tension) in tighter.iter_mut().enumerate() {
                    let (points, gradient) = (self.points(content), &self.contents.gradients[content]);
                    let dofs = points.iter().flat_map(|p| p * d..(p + 1) * d);
                    let along: f64 = dofs.zip(gradient).map(|(dof, g)| g * lambda[dof]).sum();
                    *tension -= tension_squares[content] * along;
                }
                let nearer_forces = self.forces(&nearer, &tighter);
                let nearer_left = self.share(&nearer_forces, &nearer);
                // The last correction that helped is kept; NaN does not help.
                if !(nearer_left < left) {
                    break;
                }
                (forces, left) = (nearer_forces, nearer_left);
                constants.copy_from_slice(&nearer);
                tensions.copy_from_slice(&tighter);
                if left <= FOUND {
                    break;
                }
            }
        }
        // Without any spring the share is 0/0, and no balance either.
        if !(left <= TOLERANCE) {
            return Err(unbalanced(&format!("a force at rest of {left:.1e} of the largest of a spring")));
        }
        match constants.iter().position(|k| !(*k >= 0.0)) {
            Some(_) => Err(unbalanced("a spring that the correction of forces at rest takes below zero")),
            None => Ok(left),
        }
    }

    /// `Σ_e w_e r_e r_eᵀ + Σ_c w_c g_c g_cᵀ`, with a small shift of the diagonal.
    fn normal(&self, squares: &[f64], tension_squares: &[f64]) -> Entries {
        let (d, n) = (self.mesh.dimension, self.mesh.points.len());
        let mut entries = Entries::new();
        let mut place = |dofs: &[usize], vector: &[f64], weight: f64| {
            for (a, row) in dofs.iter().enumerate() {
                // Entries are those of the lower triangle.
                for (b, column) in dofs.iter().enumerate().filter(|(_, column)| row >= *column) {
                    entries.push(Triplet::new(*row, *column, weight * vector[a] * vector[b]));
                }
            }
        };
        for (edge, weight) in squares.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            let [i, j] = self.edges.pairs[edge];
            let dofs: Vec<usize> = (i * d..(i + 1) * d).chain(j * d..(j + 1) * d).collect();
            let r = self.edges.vector(self.mesh, edge);
            let both: Vec<f64> = r.iter().map(|r| -r).chain(r.iter().copied()).collect();
            place(&dofs, &both, *weight);
        }
        for (content, weight) in tension_squares.iter().enumerate() {
            let dofs: Vec<usize> = self.points(content).iter().flat_map(|p| p * d..(p + 1) * d).collect();
            place(&dofs, &self.contents.gradients[content], *weight);
        }
        let trace: f64 = entries.iter().filter(|e| e.row == e.col).map(|e| e.val).sum();
        entries.extend((0..n).map(|dof| Triplet::new(dof, dof, RAISED * trace / n as f64)));
        entries
    }

    fn points(&self, content: usize) -> &[usize] {
        &self.network.others[self.contents.places[content]].points
    }
}

/// `f += T g`.
fn add(forces: &mut [f64], points: &[usize], gradient: &[f64], tension: f64) {
    let d = gradient.len() / points.len();
    let dofs = points.iter().flat_map(|p| p * d..(p + 1) * d);
    dofs.zip(gradient).for_each(|(dof, g)| forces[dof] += tension * g);
}

fn unbalanced(found: &str) -> Error {
    let expected = "springs above zero without force at rest";
    Error::expected("nonnegative", expected, found).of_kind(ErrorKind::Infeasible)
}
