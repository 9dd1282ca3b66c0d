//! Steps without inertia, each of which ends in equilibrium.

use super::Simulation;
use crate::dynamics::motion::Options;
use crate::dynamics::settle::StepOutcome;
use crate::error::{Error, ErrorKind, Result};

impl Simulation<'_> {
    /// Finds the equilibrium under the loads at time zero, which act at once.
    ///
    /// # Errors
    /// Newton's method does not find it.
    pub(super) fn equilibrate(&mut self) -> Result<()> {
        self.hold_still();
        // The length sets the coefficients alone; no stress relaxes, because these loads act at once.
        let step = self.settle(0.0, self.options.step, 0.0);
        if matches!(step.outcome, StepOutcome::NoResponse | StepOutcome::Stalled) {
            let expected = "loads at time zero whose equilibrium Newton's method finds: let them grow from zero";
            return Err(Error::expected("quasi-static", expected, "others").of_kind(ErrorKind::Infeasible));
        }
        self.state.displacement.iter_mut().zip(&self.target.delta).for_each(|(u, delta)| *u += delta);
        self.resistance.reset(&self.state.displacement);
        Ok(())
    }

    /// Sets the displacements of a step to zero.
    pub(super) fn hold_still(&mut self) {
        self.target.delta.fill(0.0);
        for (dof, held) in self.resistance.held.iter().enumerate() {
            if *held {
                self.target.velocity[dof] = 0.0;
            }
        }
    }

    /// `[c₁, c₂]` of a step of the length h, s.
    pub(super) fn coefficients(&self, h: f64, is_first: bool) -> [f64; 2] {
        let Options { integrator, quasi_static, .. } = self.options;
        match integrator.coefficients(h, is_first) {
            [c1, _] if quasi_static => [c1, 0.0],
            both => both,
        }
    }
}
