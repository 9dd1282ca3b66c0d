//! A motion computed step by step.
//!
//! Theory: page *Dynamics* of the book.

mod account;
mod equilibrium;
mod explicit;
mod pieces;

use super::drive::Curve;
use super::equations::Equations;
use super::integrator::{Integrator, Past};
use super::ledger::{Forces, Ledger};
use super::limit::longest_step;
use super::motion::{Motion, Options};
use super::resistance::Resistance;
use super::rows::{RowMotion, row_motion};
use super::settle::{Step, StepOutcome, Target, Trial};
use super::solver::LinearSolver;
use super::state::MotionState;
use crate::error::{Error, ErrorKind, Result};
use crate::model::displaced;
use crate::solve::generator;

/// The motion of a model from time zero.
#[derive(Debug)]
pub struct Simulation<'a> {
    motion: Motion<'a>,
    options: Options,
    resistance: Resistance<'a>,
    /// The equations of implicit methods.
    equations: Option<Box<dyn Equations>>,
    /// The coefficients and the length of the step with which the matrix of a linear model was assembled.
    factored: [f64; 3],
    state: MotionState,
    steps: usize,
    /// The accelerations of the free degrees of freedom, m/s², if the method requires them.
    acceleration: Vec<f64>,
    /// The displacement of the last step, m, and the velocity before it, m/s.
    way: Vec<f64>,
    before: Vec<f64>,
    target: Target,
    trial: Trial,
    /// Whether the forces in `trial` are those of the state.
    is_current: bool,
    viscous: Vec<f64>,
    /// 1/m of the degrees of freedom that are not held, zero of the others, 1/kg.
    inverse: Vec<f64>,
    ledger: Option<Ledger>,
    /// The number of pieces of the next step, and the largest error that was estimated, as a share of the largest displacement.
    pieces: usize,
    estimate: f64,
    /// The motion of a prepared network whose state stays in rows, and whether `state` is an earlier one.
    rows: Option<Box<dyn RowMotion + 'a>>,
    is_behind: bool,
}

impl<'a> Simulation<'a> {
    /// A simulation that starts at rest.
    ///
    /// # Errors
    /// A number is out of its range; a point that may move has no mass; the model has no response at rest; the
    /// equations do not fit into memory; or the step is too long: longer than [`Simulation::longest_step`] with
    /// symplectic Euler, or so long that a linear model that releases energy has no implicit step.
    pub fn new(motion: Motion<'a>, options: Options) -> Result<Simulation<'a>> {
        options.check()?;
        motion.check(&options)?;
        let is_implicit = options.integrator != Integrator::SymplecticEuler;
        let mut resistance = Resistance::new(&motion, options.linear, is_implicit)?;
        if !is_implicit {
            resistance.expect_explicit(options.step);
        }
        let dofs = motion.points.len();
        let equations = if is_implicit { Some(resistance.equations(&motion, options.solver)?) } else { None };
        let free = equations.as_ref().map_or(0, |equations| equations.order().len());
        let mut trial = Trial::new(dofs, free, resistance.rest.values().len());
        if options.iterations == 1 && is_implicit && !options.linear {
            let values = resistance.rest.values().to_vec();
            trial.compare_tangents(&mut resistance, &values);
        }
        // After the comparison, which has used the tangent as its room.
        trial.tangent.copy_from_slice(resistance.rest.values());
        let zero = || vec![0.0; dofs];
        let [z, y, delta, velocity, external] = std::array::from_fn(|_| zero());
        let inverse = resistance.mass.iter().zip(&resistance.held).map(|(m, held)| if *held { 0.0 } else { 1.0 / m });
        let mut simulation = Simulation {
            inverse: inverse.collect(),
            resistance,
            equations,
            // NaN equals no coefficient, so that the first step factorises.
            factored: [f64::NAN; 3],
            state: MotionState { time: 0.0, displacement: zero(), velocity: zero() },
            steps: 0,
            acceleration: zero(),
            way: zero(),
            before: zero(),
            target: Target { coefficients: [0.0; 2], z, y, delta, velocity, external },
            trial,
            is_current: false,
            viscous: zero(),
            ledger: None,
            pieces: 1,
            estimate: 0.0,
            rows: None,
            is_behind: false,
            motion,
            options,
        };
        let unstable = |expected: String| {
            Error::expected("step", expected, format!("{:e} s", options.step)).of_kind(ErrorKind::Infeasible)
        };
        let loose = || {
            let expected = "supports that hold every part of a model whose stiffness is positive definite";
            let found = "a motion that nothing resists, or that releases energy";
            Error::expected("quasi-static", expected, found).of_kind(ErrorKind::Infeasible)
        };
        if !is_implicit {
            let longest = simulation.longest_step();
            if options.step > longest {
                let expected = format!("at most {longest:.6e} s, beyond which symplectic Euler is unstable");
                return Err(unstable(expected));
            }
        } else if options.linear && !simulation.is_definite(options.step)? {
            return Err(match options.quasi_static {
                true => loose(),
                false => unstable("a step short enough for a model that releases energy as it moves".into()),
            });
        }
        let is_plain = simulation.motion.memory.is_none() && !simulation.resistance.is_damped();
        // Rows hold neither accounts nor damping: other motions keep their state as points.
        if !is_implicit && !options.account && !options.linear && is_plain {
            simulation.rows = row_motion(&simulation.motion, options.step, &simulation.inverse);
        }
        simulation.start(&zero(), &zero())?;
        Ok(simulation)
    }

    /// Starts again at time zero with these displacements, m, and velocities, m/s, `[points · dimension]`; those of
    /// held degrees of freedom are as prescribed.
    ///
    /// # Errors
    /// A list has a wrong length, or the model has no response there.
    pub fn start(&mut self, displacement: &[f64], velocity: &[f64]) -> Result<()> {
        let dofs = self.motion.points.len();
        for (key, list) in [("displacement", displacement), ("velocity", velocity)] {
            if list.len() != dofs || list.iter().any(|x| !x.is_finite()) {
                return Err(Error::expected(key, format!("{dofs} finite numbers"), format!("{} numbers", list.len())));
            }
        }
        self.steps = 0;
        self.is_behind = false;
        self.ledger = None;
        (self.pieces, self.estimate) = (1, 0.0);
        self.state = MotionState { time: 0.0, displacement: displacement.to_vec(), velocity: velocity.to_vec() };
        for (dof, prescribed) in self.motion.support.prescribed.iter().enumerate() {
            if let Some(u) = prescribed {
                (self.state.displacement[dof], self.state.velocity[dof]) = (*u, 0.0);
            }
        }
        let h = self.options.step;
        for (dof, curve) in &self.motion.drive.displacements {
            self.state.displacement[*dof] = curve.at(0.0);
            // One-sided difference: a curve need not be defined before time zero.
            self.state.velocity[*dof] = (4.0 * curve.at(h / 2.0) - 3.0 * curve.at(0.0) - curve.at(h)) / h;
        }
        let remembers = self.resistance.reset(&self.state.displacement);
        if remembers && self.options.quasi_static {
            self.equilibrate()?;
        }
        let mut has_forces = remembers && self.refresh();
        if let Some(rows) = &mut self.rows {
            rows.load(&self.target.external);
            has_forces &= rows.start(&self.state);
        }
        if !has_forces {
            let error = Error::expected("displacement", "a shape where the model has a response", "none");
            return Err(error.of_kind(ErrorKind::Infeasible));
        }
        if self.options.integrator.needs_acceleration() {
            for (dof, a) in self.acceleration.iter_mut().enumerate().filter(|(dof, _)| !self.resistance.held[*dof]) {
                let rest = self.target.external[dof] - self.trial.force[dof] - self.viscous[dof];
                *a = rest / self.resistance.mass[dof];
            }
        }
        if self.options.account {
            let elastic = self.resistance.energy(&self.state.displacement).unwrap_or(f64::NAN);
            let (free, held) = self.kinetic();
            let forces = self.forces_now();
            self.ledger = Some(Ledger::new(free + elastic, &forces, &self.resistance.held, held));
        }
        Ok(())
    }

    /// Computes loads, elastic and damping forces of the state; false if the model has none.
    fn refresh(&mut self) -> bool {
        self.motion.drive.forces_at(self.state.time, &self.resistance.mass, &mut self.target.external);
        self.resist()
    }

    /// Computes elastic and damping forces of the state; false if the model has none. Without damping they stay zero.
    fn resist(&mut self) -> bool {
        if self.resistance.is_damped() {
            self.resistance.direct(&self.state.displacement, false);
            self.resistance.viscous(&self.state.velocity, &mut self.viscous);
        }
        self.is_current = self.resistance.forces(&self.state.displacement, &mut self.trial.force);
        self.is_current
    }

    fn forces_now(&self) -> Forces<'_> {
        Forces { external: &self.target.external, elastic: &self.trial.force, viscous: &self.viscous }
    }

    /// Whether a linear model has steps. What its solver cannot determine, a Cholesky factor does, so that the answer
    /// does not depend on the solver.
    ///
    /// # Errors
    /// The factor does not fit into memory, or the solver cannot solve the equations of a model that has steps.
    fn is_definite(&mut self, h: f64) -> Result<bool> {
        let coefficients = self.coefficients(h, true);
        self.resistance.prepare(h);
        let is_prepared = self.factor(coefficients, h);
        let Some(equations) = &mut self.equations else { return Ok(true) };
        let mut random = generator();
        // A random force has a part along every motion; a smooth one may miss the motion that releases energy.
        let mut x: Vec<f64> = equations.order().iter().map(|_| random()).collect();
        if let Some(is_definite) = equations.is_definite(is_prepared, &mut x) {
            return Ok(is_definite);
        }
        let resistance = &self.resistance;
        let mut proof = resistance.equations(&self.motion, LinearSolver::Factor)?;
        resistance.assemble(coefficients, &resistance.linear_tangent(), proof.as_mut());
        match proof.prepare() {
            true if !is_prepared => {
                let problem = "its equations have no incomplete factor, which conjugate gradients need";
                Err(Error::at("model", problem).of_kind(ErrorKind::Infeasible))
            }
            is_definite => Ok(is_definite),
        }
    }

    /// Prepares the matrix of a linear model, unless it is prepared already.
    fn factor(&mut self, coefficients: [f64; 2], h: f64) -> bool {
        let key = [coefficients[0], coefficients[1], h];
        let Some(equations) = self.equations.as_mut().filter(|_| self.factored != key) else { return true };
        self.resistance.assemble(coefficients, &self.resistance.linear_tangent(), equations.as_mut());
        self.factored = key;
        equations.prepare()
    }

    /// The longest stable step of symplectic Euler at rest, s: `4/(γ + √(γ² + 4ω²))`, with upper bounds of the largest
    /// ω² of `M⁻¹K` and γ of `M⁻¹C`. A model that stiffens as it moves requires shorter steps.
    pub fn longest_step(&self) -> f64 {
        let [square, damping] = self.resistance.largest();
        longest_step(square, damping)
    }

    /// The current state.
    pub fn state(&mut self) -> &MotionState {
        if let Some(rows) = self.rows.as_ref().filter(|_| self.is_behind) {
            rows.write(&mut self.state);
            self.is_behind = false;
        }
        &self.state
    }

    /// Whether no displacement is larger than this, m, and every velocity is a number.
    pub fn is_within(&self, largest: f64) -> bool {
        self.rows.as_ref().map_or_else(|| self.state.is_within(largest), |rows| rows.is_within(largest))
    }

    /// The current positions, `[points × dimension]`, m.
    pub fn positions(&mut self) -> Vec<f64> {
        displaced(self.motion.points, &self.state().displacement)
    }

    /// Advances by one step.
    pub fn step(&mut self) -> Step {
        if self.equations.is_none() {
            return self.leap();
        }
        let h = self.options.step;
        let time = (self.steps + 1) as f64 * h;
        let step = if self.divides() { self.step_in_pieces(time, h) } else { self.step_to(time, h) };
        self.steps += usize::from(step.outcome != StepOutcome::NoResponse);
        step
    }

    /// Makes an implicit step of the length h that ends at `time`, s.
    fn step_to(&mut self, time: f64, h: f64) -> Step {
        self.hold_still();
        for (dof, curve) in &self.motion.drive.displacements {
            self.target.delta[*dof] = curve.at(time) - self.state.displacement[*dof];
            self.target.velocity[*dof] = rate(curve, time, h);
        }
        let step = self.settle(time, h, h);
        if step.outcome == StepOutcome::NoResponse {
            self.resistance.prepare(0.0);
            self.refresh();
            return step;
        }
        std::mem::swap(&mut self.before, &mut self.state.velocity);
        std::mem::swap(&mut self.way, &mut self.target.delta);
        self.state.velocity.copy_from_slice(&self.target.velocity);
        // A driven point is on its curve to the last bit.
        self.state.displacement.iter_mut().zip(&self.way).for_each(|(u, way)| *u += way);
        for (dof, curve) in &self.motion.drive.displacements {
            self.state.displacement[*dof] = curve.at(time);
        }
        self.state.time = time;
        self.resistance.advance(&self.state.displacement);
        self.book();
        step
    }

    /// Solves for the end of an implicit step of the length h, s, over which stress relaxes for the time `relaxing`, s.
    fn settle(&mut self, time: f64, h: f64, relaxing: f64) -> Step {
        let Options { integrator, iterations, tolerance, linear, quasi_static, .. } = self.options;
        let is_first = self.steps == 0;
        self.target.coefficients = self.coefficients(h, is_first);
        self.resistance.prepare(relaxing);
        if linear {
            // Later steps are stiffer than the first one, which `new` has tried, and so is a jump.
            self.factor(self.target.coefficients, relaxing);
        }
        for dof in 0..self.state.velocity.len() {
            let (v, a) = (self.state.velocity[dof], self.acceleration[dof]);
            let past = Past { v, a, way: self.way[dof], before: self.before[dof] };
            [self.target.z[dof], self.target.y[dof]] = match quasi_static {
                true => [0.0; 2],
                false => integrator.predict(h, is_first, past),
            };
        }
        self.motion.drive.forces_at(time, &self.resistance.mass, &mut self.target.external);
        let equations = self.equations.as_mut().expect("only implicit methods settle").as_mut();
        let (start, Target { y, .. }) = (&self.state.displacement, &self.target);
        if self.resistance.has_dampers() && !linear {
            // For implicit Euler the dampers as they are, which has the accuracy of the method; for the others as they
            // will be.
            let ahead: Vec<f64> = match integrator {
                Integrator::ImplicitEuler => start.clone(),
                _ => start.iter().zip(y).map(|(u, y)| u + y).collect(),
            };
            self.resistance.direct(&ahead, false);
        }
        let (resistance, target, trial) = (&mut self.resistance, &mut self.target, &mut self.trial);
        let step = match linear {
            true => trial.solve_linear(resistance, target, start, equations),
            false => trial.settle(resistance, target, start, equations, iterations, tolerance),
        };
        self.is_current = !linear && step.outcome != StepOutcome::Linearized;
        let [c1, c2] = target.coefficients;
        for &dof in equations.order() {
            target.velocity[dof] = c1 * (target.delta[dof] - target.z[dof]);
            self.acceleration[dof] = match step.outcome {
                StepOutcome::NoResponse => self.acceleration[dof],
                _ => c2 * (target.delta[dof] - target.y[dof]),
            };
        }
        step
    }
}

/// The velocity of a driven degree of freedom at the end of the step h, m/s.
fn rate(curve: &Curve, time: f64, h: f64) -> f64 {
    (curve.at(time + h / 2.0) - curve.at(time - h / 2.0)) / h
}
