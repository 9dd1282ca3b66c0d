//! The memory of a body at large deformation in explicit steps of one length: one pass over the material points gives the forces and the states
//! after the step.
//!
//! Theory: page *Springs that forget* of the book.

use super::decay::Decay;
use super::term::BranchTerm;
use crate::model::{BranchRule, Branches, MaterialPoints};

/// With steps of one length h the state that is known when a step begins, `S = e G_n + (γ − e) H_n`, is all that is kept:
///
/// ```text
/// σ J = g μ (F S Fᵀ − γ J^(2/3) 1)        S ← e S + γ (1 − e) H
/// ```
#[derive(Debug, Clone)]
pub struct ExplicitMemory {
    branches: Branches,
    rest: Vec<f64>,
    x: Vec<f64>,
    decays: Vec<Decay>,
    rules: Vec<BranchRule>,
    /// The forces at the present shape, `[points × dimension]`, N, and those at the end of the step that is computed.
    force: Vec<f64>,
    ahead: Vec<f64>,
    /// The energy of each term, J, and that at the end of the step.
    energies: Vec<f64>,
    energies_ahead: Vec<f64>,
    dissipated: f64,
    /// Whether a step is being computed.
    is_prepared: bool,
    /// Whether the states are known.
    is_sound: bool,
}

impl ExplicitMemory {
    /// The branches of a body whose points are at `rest`, `[points × dimension]`, m, for steps of `step`, s. Terms that yield are not served.
    pub fn new(points: &MaterialPoints, rest: &[f64], terms: &[BranchTerm], step: f64) -> ExplicitMemory {
        let decays: Vec<Decay> = terms.iter().map(|term| Decay::new(step, term.time)).collect();
        let share = |term: usize, region: usize| terms[term].shares.get(region).copied().unwrap_or(0.0);
        let branches = Branches::new(points, rest, terms.len(), &share);
        let zero = vec![0.0; rest.len()];
        let still = vec![0.0; terms.len()];
        ExplicitMemory {
            branches,
            rest: rest.to_vec(),
            x: rest.to_vec(),
            rules: decays.iter().map(rule).collect(),
            decays,
            force: zero.clone(),
            ahead: zero,
            energies: still.clone(),
            energies_ahead: still,
            dissipated: 0.0,
            is_prepared: false,
            is_sound: false,
        }
    }

    pub(super) fn dofs(&self) -> usize {
        self.rest.len()
    }

    /// The number of numbers that are remembered.
    pub fn numbers(&self) -> usize {
        self.branches.numbers()
    }

    pub(super) fn reset(&mut self, u: &[f64]) -> bool {
        let x: Vec<f64> = self.rest.iter().zip(u).map(|(x, u)| x + u).collect();
        let first: Vec<BranchRule> = self
            .decays
            .iter()
            // Forces against a jump are those of the state at rest and of the whole content. Then the state becomes `e
            // G + (γ − e) H`, the one that the first step begins with.
            .map(|Decay { left, mean, .. }| BranchRule { content: 1.0, left: *left, taken: mean - left })
            .collect();
        self.force.fill(0.0);
        self.dissipated = 0.0;
        self.is_prepared = false;
        self.is_sound =
            self.branches.forget(&self.rest) && self.branches.pull(&x, &first, &mut self.force, &mut self.energies);
        self.is_sound
    }

    pub(super) fn prepare(&mut self, step: f64) {
        // A step of length zero asks for the present forces, which the last step has computed.
        self.is_prepared = step > 0.0;
    }

    /// Adds the forces, N: those at the end of a step to the displacements u if one is prepared, or the present ones; false if there are none.
    pub(super) fn pull(&mut self, u: &[f64], force: &mut [f64]) -> bool {
        if self.is_prepared {
            self.ahead.fill(0.0);
            let mut place = std::mem::take(&mut self.x);
            place.iter_mut().zip(&self.rest).zip(u).for_each(|((x, rest), u)| *x = rest + u);
            // States of which some have advanced are not known.
            self.is_sound =
                self.is_sound && self.branches.pull(&place, &self.rules, &mut self.ahead, &mut self.energies_ahead);
            self.x = place;
        }
        let own = if self.is_prepared { &self.ahead } else { &self.force };
        force.iter_mut().zip(own).for_each(|(f, own)| *f += own);
        self.is_sound || !self.is_prepared
    }

    pub(super) fn advance(&mut self) {
        std::mem::swap(&mut self.force, &mut self.ahead);
        std::mem::swap(&mut self.energies, &mut self.energies_ahead);
        for ((energy, before), decay) in self.energies.iter_mut().zip(&self.energies_ahead).zip(&self.decays) {
            // What is below zero is rounding.
            *energy = energy.max(0.0);
            self.dissipated += decay.lost(*before, *energy);
        }
    }

    pub(super) fn stored(&self) -> f64 {
        self.energies.iter().sum()
    }

    pub(super) fn dissipated(&self) -> f64 {
        self.dissipated
    }
}

fn rule(decay: &Decay) -> BranchRule {
    BranchRule { content: decay.mean, left: decay.left, taken: decay.mean * decay.gone() }
}
