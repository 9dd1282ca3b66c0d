//! Steps without equations.

use super::{Simulation, rate};
use crate::dynamics::pass::{Changed, Given, leap};
use crate::dynamics::settle::{Step, StepOutcome};

impl Simulation<'_> {
    /// A step of symplectic Euler, `v ← v + h M⁻¹ (f − C v − F)`, `u ← u + h v`, in one pass over the degrees of freedom.
    pub(super) fn leap(&mut self) -> Step {
        if self.rows.is_some() {
            return self.leap_in_rows();
        }
        let h = self.options.step;
        // A product and not a sum of steps, whose rounding would grow with their number.
        let time = (self.steps + 1) as f64 * h;
        let driven = &self.motion.drive.displacements;
        for ((dof, _), start) in driven.iter().zip(&mut self.target.delta) {
            // `delta` is free in explicit methods, and keeps where driven points were.
            *start = self.state.displacement[*dof];
        }
        let (displacement, way, velocity) = (&mut self.state.displacement, &mut self.way, &mut self.before);
        let given = Given {
            velocity: &self.state.velocity,
            external: &self.target.external,
            elastic: &self.trial.force,
            viscous: &self.viscous,
            inverse: &self.inverse,
        };
        leap(h, Changed { displacement, way, velocity }, given);
        std::mem::swap(&mut self.before, &mut self.state.velocity);
        for ((dof, curve), start) in driven.iter().zip(&self.target.delta) {
            // A driven point is on its curve to the last bit.
            self.state.displacement[*dof] = curve.at(time);
            self.state.velocity[*dof] = rate(curve, time, h);
            self.way[*dof] = curve.at(time) - start;
        }
        (self.steps, self.state.time) = (self.steps + 1, time);
        self.resistance.prepare(h);
        if !self.refresh_changed() {
            return self.step_back();
        }
        self.resistance.advance(&self.state.displacement);
        self.book();
        Step::explicit(StepOutcome::Converged)
    }

    /// Makes a step of symplectic Euler in a motion whose points and forces are in rows.
    fn leap_in_rows(&mut self) -> Step {
        let h = self.options.step;
        let time = (self.steps + 1) as f64 * h;
        let Some(rows) = &mut self.rows else { return Step::explicit(StepOutcome::NoResponse) };
        let driven = &self.motion.drive.displacements;
        let driven: Vec<_> = driven.iter().map(|(dof, curve)| (*dof, [curve.at(time), rate(curve, time, h)])).collect();
        // Also if the step fails: the rows are then back, but only up to rounding.
        self.is_behind = true;
        if !rows.step(&driven) {
            return Step::explicit(StepOutcome::NoResponse);
        }
        (self.steps, self.state.time) = (self.steps + 1, time);
        if !self.motion.drive.is_steady() {
            self.motion.drive.forces_at(time, &self.resistance.mass, &mut self.target.external);
            rows.load(&self.target.external);
        }
        Step::explicit(StepOutcome::Converged)
    }

    /// Restores the state before an explicit step.
    fn step_back(&mut self) -> Step {
        self.steps -= 1;
        self.state.time = self.steps as f64 * self.options.step;
        self.state.displacement.iter_mut().zip(&self.way).for_each(|(u, way)| *u -= way);
        std::mem::swap(&mut self.before, &mut self.state.velocity);
        // A step of no length forgets what the failed one has prepared.
        self.resistance.prepare(0.0);
        self.refresh();
        Step::explicit(StepOutcome::NoResponse)
    }

    /// Computes loads, elastic and damping forces after a step; loads that do not change are kept.
    fn refresh_changed(&mut self) -> bool {
        if self.motion.drive.is_steady() { self.resist() } else { self.refresh() }
    }
}
