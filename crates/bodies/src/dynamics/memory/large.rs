//! The memory of a body at large deformation: constants of springs that relax towards those of the present shape.
//!
//! Theory: page *Springs that forget* of the book.

use super::decay::Decay;
use super::explicit::ExplicitMemory;
use super::form::{BranchForm, Form};
use super::term::BranchTerm;
use crate::error::{Error, Result};
use crate::material::Relaxation;
use crate::model::{MaterialPoints, displaced};

/// Each term is a branch with the elastic state G at every material point, which relaxes towards that of the present shape:
///
/// ```text
/// Ġ = (H − G)/τ        H = J^(2/3) C⁻¹        σ J = g μ (F G Fᵀ − J^(2/3) 1)
/// ```
///
/// In springs, `k_ab = −g μ V₀ ∇N_a·G ∇N_b`, the equation is the same. It is linear in the state, so that the states of the cells at an edge
/// add up. With H linear over a step the state at its end is `e G_n + (γ − e) H_n + (1 − γ) H`, and because `F H Fᵀ = J^(2/3) 1` the forces
/// there are those of the constant state `e G_n + (γ − e) H_n` and of the content with γ in place of 1: they have a potential.
#[derive(Debug, Clone)]
pub struct LargeMemory {
    form: Form,
    rest: Vec<f64>,
    shares: Vec<f64>,
    times: Vec<f64>,
    /// The state of each term, and H, in the numbers of the form.
    states: Vec<Vec<f64>>,
    target: Vec<f64>,
    /// The energy of each term, over its share, J.
    energies: Vec<f64>,
    decays: Vec<Decay>,
    /// `Σ_i g_i (e G_n + (γ − e) H_n)` and `Σ_i g_i γ_i` of the step that is prepared.
    during: Vec<f64>,
    content: f64,
    dissipated: f64,
}

impl LargeMemory {
    /// The branches of a body whose points are at `rest`, `[points × dimension]`, m, with the shares of shear of a relaxation; shares of bulk
    /// are not used ([`Relaxation::check_large`] refuses them).
    ///
    /// # Errors
    /// There are so many pairs of points that they cannot be numbered.
    pub fn new(points: MaterialPoints, form: BranchForm, rest: &[f64], relaxation: &Relaxation) -> Result<LargeMemory> {
        let form = Form::new(points, form);
        let terms = relaxation.terms();
        let shape = form.shape(rest).ok_or_else(|| Error::expected("mesh", "cells with a volume", "none"))?;
        let target = shape.target;
        let mut memory = LargeMemory {
            rest: rest.to_vec(),
            shares: terms.iter().map(|term| term.shear).collect(),
            times: terms.iter().map(|term| term.time).collect(),
            states: vec![target.clone(); terms.len()],
            energies: vec![0.0; terms.len()],
            decays: Vec::new(),
            during: target.clone(),
            content: 0.0,
            dissipated: 0.0,
            form,
            target,
        };
        memory.prepare(0.0);
        Ok(memory)
    }

    /// Makes this memory one for explicit steps of the length `step`, s.
    pub(super) fn for_explicit(&self, step: f64) -> ExplicitMemory {
        let points = self.form.points();
        let regions = points.each().fold(0, |most, point| most.max(point.region + 1));
        let term =
            |(time, share): (&f64, &f64)| BranchTerm { time: *time, yield_stress: None, shares: vec![*share; regions] };
        let terms: Vec<BranchTerm> = self.times.iter().zip(&self.shares).map(term).collect();
        ExplicitMemory::new(points, &self.rest, &terms, step)
    }

    pub(super) fn dofs(&self) -> usize {
        self.rest.len()
    }

    /// The number of numbers that are remembered.
    pub fn numbers(&self) -> usize {
        self.states.len() * self.target.len()
    }

    pub(super) fn places(&self) -> Vec<(usize, usize)> {
        self.form.places()
    }

    pub(super) fn reset(&mut self, u: &[f64]) -> bool {
        let Some(rest) = self.form.shape(&self.rest) else { return false };
        let Some(shape) = self.form.shape(&displaced(&self.rest, u)) else { return false };
        self.states.iter_mut().for_each(|state| state.copy_from_slice(&rest.target));
        // The jump stores energy before anything relaxes; what is below zero is rounding.
        self.energies.fill(shape.energy(&rest.target).max(0.0));
        self.target = shape.target;
        self.dissipated = 0.0;
        self.prepare(0.0);
        true
    }

    pub(super) fn prepare(&mut self, step: f64) {
        self.decays = self.times.iter().map(|time| Decay::new(step, *time)).collect();
        self.content = self.shares.iter().zip(&self.decays).map(|(share, decay)| share * decay.mean).sum();
        self.during.fill(0.0);
        for ((state, decay), share) in self.states.iter().zip(&self.decays).zip(&self.shares) {
            let (kept, taken) = (share * decay.left, share * (decay.mean - decay.left));
            for ((sum, g), h) in self.during.iter_mut().zip(state).zip(&self.target) {
                *sum += kept * g + taken * h;
            }
        }
    }

    pub(super) fn add(&self, u: &[f64], force: &mut [f64], tangent: Option<&mut [f64]>) -> Option<f64> {
        let x = displaced(&self.rest, u);
        self.form.evaluate(&self.during, &|_| self.content, &x, force, tangent.unwrap_or_default())
    }

    pub(super) fn advance(&mut self, u: &[f64]) {
        // A step that was computed has a shape with a response.
        let Some(shape) = self.form.shape(&displaced(&self.rest, u)) else { return };
        for (term, state) in self.states.iter_mut().enumerate() {
            let Decay { left, mean, .. } = self.decays[term];
            for ((g, before), after) in state.iter_mut().zip(&self.target).zip(&shape.target) {
                *g = left * *g + (mean - left) * before + (1.0 - mean) * after;
            }
            // What is below zero is rounding.
            let energy = shape.energy(state).max(0.0);
            self.dissipated += self.shares[term] * self.decays[term].lost(self.energies[term], energy);
            self.energies[term] = energy;
        }
        self.target = shape.target;
    }

    pub(super) fn stored(&self, u: &[f64]) -> Option<f64> {
        // With no step prepared the state during it is the present one.
        self.form.evaluate(&self.during, &|_| self.content, &displaced(&self.rest, u), &mut [], &mut [])
    }

    pub(super) fn dissipated(&self) -> f64 {
        self.dissipated
    }
}
