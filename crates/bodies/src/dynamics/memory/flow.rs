//! The memory of a body at large deformation, material point by material point: branches that yield, and regions that relax unlike.
//!
//! Theory: page *Springs that forget* of the book.

use super::decay::Decay;
use super::form::{BranchForm, Form, Present, SYMMETRIC, tensor};
use super::term::BranchTerm;
use super::yielding::{Drive, Yield};
use crate::error::{Error, Result};
use crate::model::{MaterialPoints, displaced};
use nalgebra::Matrix3;

/// A branch with the yield stress σ_y flows at the rate of what its von Mises stress q exceeds it by:
///
/// ```text
/// Ġ = r (H − G)/τ        r = max(0, 1 − σ_y/q)        q = √(3/2) |dev σ|,  dev σ = g μ dev(F G Fᵀ)/J
/// ```
///
/// A step takes for the integral of r/τ at each point what the two steps before it lead one to expect, so that it has a potential; when it ends, the
/// integral is that with which q is right (`Yield`).
#[derive(Debug, Clone)]
pub struct FlowMemory {
    form: Form,
    rest: Vec<f64>,
    /// The positions to which the states belong, m.
    x: Vec<f64>,
    terms: Vec<BranchTerm>,
    branches: Vec<Branch>,
    /// H of each point.
    target: Vec<f64>,
    /// `Σ_i g_i (e G_n + (γ − e) H_n)` and `Σ_i g_i γ_i` of each point.
    during: Vec<f64>,
    content: Vec<f64>,
    /// The length of the step that is prepared, and those of the last two, s.
    step: f64,
    steps: [f64; 2],
    dissipated: f64,
}

/// What one term remembers.
#[derive(Debug, Clone)]
struct Branch {
    /// G, six numbers for each point.
    state: Vec<f64>,
    /// The energy, J, of each point.
    energies: Vec<f64>,
    /// The mean of r/τ over the last step and over the one before, 1/s, of each point; none without a yield stress.
    flows: Vec<[f64; 2]>,
}

impl FlowMemory {
    /// The branches of a body whose points are at `rest`, `[points × dimension]`, m.
    ///
    /// # Errors
    /// Some cell has no volume.
    pub fn new(points: MaterialPoints, rest: &[f64], terms: &[BranchTerm]) -> Result<FlowMemory> {
        let form = Form::new(points, BranchForm::Tensors);
        let shape = form.shape(rest).ok_or_else(|| Error::expected("mesh", "cells with a volume", "none"))?;
        let count = form.points().len();
        let branch = |term: &BranchTerm| Branch {
            state: shape.target.clone(),
            energies: vec![0.0; count],
            flows: if term.yield_stress.is_some() { vec![[0.0; 2]; count] } else { Vec::new() },
        };
        let mut memory = FlowMemory {
            rest: rest.to_vec(),
            x: rest.to_vec(),
            branches: terms.iter().map(branch).collect(),
            terms: terms.to_vec(),
            during: shape.target.clone(),
            content: vec![0.0; count],
            target: shape.target,
            step: 0.0,
            steps: [0.0; 2],
            dissipated: 0.0,
            form,
        };
        memory.prepare(0.0);
        Ok(memory)
    }

    pub(super) fn dofs(&self) -> usize {
        self.rest.len()
    }

    pub(super) fn terms(&self) -> &[BranchTerm] {
        &self.terms
    }

    pub(super) fn points(&self) -> &MaterialPoints {
        self.form.points()
    }

    pub(super) fn rest(&self) -> &[f64] {
        &self.rest
    }

    /// The number of numbers that are remembered.
    pub fn numbers(&self) -> usize {
        let of = |branch: &Branch| branch.state.len() + branch.energies.len() + 2 * branch.flows.len();
        self.branches.iter().map(of).sum::<usize>() + self.target.len()
    }

    pub(super) fn places(&self) -> Vec<(usize, usize)> {
        self.form.places()
    }

    pub(super) fn reset(&mut self, u: &[f64]) -> bool {
        let Some(rest) = self.form.shape(&self.rest) else { return false };
        let x = displaced(&self.rest, u);
        let Some(shape) = self.form.shape(&x) else { return false };
        let d = self.form.points().dimension;
        for (branch, term) in self.branches.iter_mut().zip(&self.terms) {
            // A branch has not relaxed at the start: its state is the shape at rest, whatever the displacements are.
            branch.state.copy_from_slice(&rest.target);
            for (i, point) in self.form.points().each().enumerate() {
                let Some(present) = Present::of(&point, &x, d) else { return false };
                let share = term.shares.get(point.region).copied().unwrap_or(0.0);
                let g = tensor(&branch.state[6 * i..6 * i + 6]);
                branch.energies[i] = energy(&present, &g, share * point.weight);
                if let (Some(flow), Some(limit)) = (branch.flows.get_mut(i), term.yield_stress) {
                    let stress = stress(&present, &g, share * point.modulus);
                    let rate = if stress > limit { (1.0 - limit / stress) / term.time } else { 0.0 };
                    // Both alike, because nothing is known of how the rate changes.
                    *flow = [rate; 2];
                }
            }
        }
        self.target = shape.target;
        self.x = x;
        (self.dissipated, self.steps) = (0.0, [0.0; 2]);
        self.prepare(0.0);
        true
    }

    /// The rule of a point in the step that is prepared.
    fn decay(&self, term: &BranchTerm, branch: &Branch, point: usize) -> Decay {
        let Some([last, before]) = branch.flows.get(point) else { return Decay::new(self.step, term.time) };
        let [h1, h0] = self.steps;
        // The rate at the middle of this step, on the line through those at the middles of the last two.
        let ahead = if h1 + h0 > 0.0 { (last - before) * (self.step + h1) / (h1 + h0) } else { 0.0 };
        // The line may lead below zero or beyond 1/τ, which no flow passes.
        Decay::new(self.step * (last + ahead).clamp(0.0, 1.0 / term.time), 1.0)
    }

    pub(super) fn prepare(&mut self, step: f64) {
        self.step = step;
        let (mut during, mut content) = (std::mem::take(&mut self.during), std::mem::take(&mut self.content));
        during.fill(0.0);
        content.fill(0.0);
        for (term, branch) in self.terms.iter().zip(&self.branches) {
            for (i, point) in self.form.points().each().enumerate() {
                let share = term.shares.get(point.region).copied().unwrap_or(0.0);
                // Each region has few of the terms of the body.
                if share == 0.0 {
                    continue;
                }
                let decay = self.decay(term, branch, i);
                content[i] += share * decay.mean;
                let (kept, taken) = (share * decay.left, share * (decay.mean - decay.left));
                for at in 6 * i..6 * i + 6 {
                    during[at] += kept * branch.state[at] + taken * self.target[at];
                }
            }
        }
        (self.during, self.content) = (during, content);
    }

    pub(super) fn add(&self, u: &[f64], force: &mut [f64], tangent: Option<&mut [f64]>) -> Option<f64> {
        let x = displaced(&self.rest, u);
        self.form.evaluate(&self.during, &|i| self.content[i], &x, force, tangent.unwrap_or_default())
    }

    pub(super) fn advance(&mut self, u: &[f64]) {
        let x = displaced(&self.rest, u);
        // A step that was computed has a shape with a response.
        let Some(shape) = self.form.shape(&x) else { return };
        let d = self.form.points().dimension;
        for (term, branch) in self.terms.iter().zip(&mut self.branches) {
            for (i, point) in self.form.points().each().enumerate() {
                let share = term.shares.get(point.region).copied().unwrap_or(0.0);
                let shapes = Present::of(&point, &x, d).zip(Present::of(&point, &self.x, d));
                let Some((present, last)) = shapes.filter(|_| share > 0.0) else { continue };
                let at = 6 * i..6 * i + 6;
                let [g, before, after] =
                    [&branch.state[at.clone()], &self.target[at.clone()], &shape.target[at.clone()]].map(tensor);
                let decay = match (branch.flows.get_mut(i), term.yield_stress) {
                    (Some(flow), Some(limit)) => {
                        let scale = |shape: &Present| share * point.modulus / shape.f.determinant();
                        let [ahead, behind] = [scale(&present), scale(&last)];
                        let drive = Drive::new(
                            [deviator(&last, &g) * behind, deviator(&last, &after) * behind],
                            [deviator(&present, &(g - before)) * ahead, deviator(&present, &before) * ahead],
                        );
                        let x = Yield { limit, steps: self.step / term.time }.flow(&drive);
                        // A jump has no length over which a mean could be taken.
                        let rate = if self.step > 0.0 { x / self.step } else { flow[0] };
                        *flow = [rate, flow[0]];
                        Decay::new(x, 1.0)
                    }
                    _ => Decay::new(self.step, term.time),
                };
                let Decay { left, mean, .. } = decay;
                let g = g * left + before * (mean - left) + after * (1.0 - mean);
                SYMMETRIC.iter().zip(&mut branch.state[at]).for_each(|(k, number)| *number = g[*k]);
                let energy = energy(&present, &g, share * point.weight);
                self.dissipated += decay.lost(branch.energies[i], energy);
                branch.energies[i] = energy;
            }
        }
        self.target = shape.target;
        self.x = x;
        if self.step > 0.0 {
            // The rate at the start is that of a step of no length.
            self.steps = [self.step, self.steps[0]];
        }
    }

    pub(super) fn stored(&self, u: &[f64]) -> Option<f64> {
        // With no step prepared the state during it is the present one.
        self.form.evaluate(&self.during, &|i| self.content[i], &displaced(&self.rest, u), &mut [], &mut [])
    }

    pub(super) fn dissipated(&self) -> f64 {
        self.dissipated
    }
}

/// `dev(F G Fᵀ)`.
fn deviator(present: &Present, g: &Matrix3<f64>) -> Matrix3<f64> {
    let all = present.f * g * present.f.transpose();
    all - Matrix3::from_diagonal_element(all.trace() / 3.0)
}

/// `√(3/2) |dev σ|`, Pa, of the modulus g μ.
fn stress(present: &Present, g: &Matrix3<f64>, modulus: f64) -> f64 {
    // Von Mises' stress is `√(3/2)` of the norm of the deviator, so that in a tension test it is the tension.
    1.5f64.sqrt() * modulus * deviator(present, g).norm() / present.f.determinant()
}

/// `w (½ tr(F G Fᵀ) − (3/2) J^(2/3))`; what is below zero is rounding.
fn energy(present: &Present, g: &Matrix3<f64>, weight: f64) -> f64 {
    let straight = (present.f * g * present.f.transpose()).trace();
    // At rest `F G Fᵀ` is `J^(2/3) I` with the trace `3 J^(2/3)`, so that the energy is zero.
    (weight * (straight / 2.0 - 1.5 * present.size)).max(0.0)
}
