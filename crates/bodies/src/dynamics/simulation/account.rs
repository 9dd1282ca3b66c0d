//! The account of a motion.

use super::Simulation;
use crate::dynamics::ledger::{self, Account, EnergyBalance, Ledger};
use crate::dynamics::resistance::Resistance;

impl Simulation<'_> {
    /// Adds the step to the ledger.
    pub(super) fn book(&mut self) {
        let Some(mut ledger) = self.ledger.take() else { return };
        if !self.is_current {
            self.is_current = self.resistance.forces(&self.state.displacement, &mut self.trial.force);
        }
        // Explicit methods have computed the damping forces of this state for the next step already.
        if self.equations.is_some() {
            self.resistance.viscous(&self.state.velocity, &mut self.viscous);
        }
        let (free, _) = self.kinetic();
        let is_damped = self.resistance.is_damped();
        ledger.add(&self.way, &self.forces_now(), &self.resistance.held, is_damped);
        ledger.largest = ledger
            .largest
            .max(free)
            .max(ledger.work.value().abs())
            .max(ledger.dissipated.value() + self.resistance.relaxed());
        self.ledger = Some(ledger);
    }

    /// The kinetic energy of the free degrees of freedom and of the held ones, J.
    pub(super) fn kinetic(&self) -> (f64, f64) {
        let Resistance { mass, held, .. } = &self.resistance;
        match self.options.quasi_static {
            true => (0.0, 0.0),
            false => ledger::kinetic(mass, held, &self.state.velocity),
        }
    }

    /// Energy and momentum of the current state.
    pub fn account(&mut self) -> Account {
        self.state();
        let d = self.motion.dimension();
        let (free, held) = self.kinetic();
        // A state without a response has no energy, and accounts show NaN as unknown.
        let elastic = self.resistance.energy(&self.state.displacement).unwrap_or(f64::NAN);
        let x = self.positions();
        let (mass, v) = (&self.resistance.mass, &self.state.velocity);
        let sums = |ledger: &mut Ledger| {
            let energy = free + elastic;
            let (work, dissipated) = (ledger.work.value(), ledger.dissipated.value() + self.resistance.relaxed());
            let gained = energy - ledger.start - work + dissipated;
            ledger.largest = ledger.largest.max(energy.abs());
            // A body that never moved has 0/0.
            let drift = if gained == 0.0 { 0.0 } else { gained / ledger.largest };
            // What moves held points gives them their kinetic energy as well, which the sums leave out.
            EnergyBalance { work: work + held - ledger.held, dissipated, drift }
        };
        Account {
            time: self.state.time,
            kinetic: free + held,
            elastic,
            momentum: ledger::momentum(mass, v, d),
            angular_momentum: ledger::angular_momentum(mass, &x, v, d),
            balance: self.ledger.as_mut().map(sums),
        }
    }
}
