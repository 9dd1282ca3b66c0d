//! The definition of a motion, and the options by which it is computed.

use super::damping::Damping;
use super::drive::Drive;
use super::integrator::Integrator;
use super::memory::Memory;
use super::solver::LinearSolver;
use crate::error::{Error, Result};
use crate::model::{Elastic, Support};
use std::fmt;

/// A model with masses, supports, damping and loads.
#[derive(Clone)]
pub struct Motion<'a> {
    /// The model: finite elements or a network.
    pub model: &'a dyn Elastic,
    /// The positions at rest, `[points × dimension]`, m.
    pub points: &'a [f64],
    /// The masses, `[points]`, kg.
    pub masses: &'a [f64],
    /// The support. Its displacements hold at all times, except those of degrees of freedom that `drive` prescribes.
    pub support: Support,
    /// The damping.
    pub damping: Damping,
    /// What the model remembers beside its elastic forces: stress that relaxes.
    pub memory: Option<Memory>,
    /// Forces and prescribed displacements over time.
    pub drive: Drive,
}

impl<'a> Motion<'a> {
    /// A free model without damping, loads or supports.
    pub fn free(model: &'a dyn Elastic, points: &'a [f64], masses: &'a [f64]) -> Motion<'a> {
        let support = Support { prescribed: vec![None; points.len()] };
        Motion { model, points, masses, support, damping: Damping::default(), memory: None, drive: Drive::default() }
    }

    pub(super) fn dimension(&self) -> usize {
        // Masses may be missing until they are checked, and nothing may be divided by zero before.
        self.points.len() / self.masses.len().max(1)
    }

    /// For each degree of freedom whether its motion is prescribed.
    pub(super) fn held(&self) -> Vec<bool> {
        let mut held: Vec<bool> = self.support.prescribed.iter().map(Option::is_some).collect();
        self.drive.displacements.iter().for_each(|(dof, _)| held[*dof] = true);
        held
    }

    pub(super) fn check(&self, options: &Options) -> Result<()> {
        let (dofs, points) = (self.points.len(), self.masses.len());
        let d = self.dimension();
        if !(1..=3).contains(&d) || d * points != dofs {
            let expected = "one mass per point of one to three coordinates";
            return Err(Error::expected("masses", expected, format!("{points} for {dofs} coordinates")));
        }
        if self.support.prescribed.len() != dofs {
            let expected = format!("one entry for each of {dofs} degrees of freedom");
            return Err(Error::expected("support", expected, self.support.prescribed.len()));
        }
        if let Some(u) = self.support.prescribed.iter().flatten().find(|u| !u.is_finite()) {
            return Err(Error::expected("support", "finite displacements in m", u));
        }
        self.drive.check(dofs, d)?;
        self.damping.check(points)?;
        if let Some(memory) = &self.memory {
            if memory.dofs() != dofs {
                return Err(Error::expected("memory", format!("one of {dofs} degrees of freedom"), memory.dofs()));
            }
            if memory.is_linear() != options.linear {
                let of = |linear| if linear { "of a linear model" } else { "at large deformation" };
                return Err(Error::expected("memory", format!("one {}", of(options.linear)), of(memory.is_linear())));
            }
        }
        // Without inertia masses do not act, and are not checked.
        if options.quasi_static {
            return match self.damping.is_none() {
                true => Ok(()),
                false => Err(Error::expected("damping", "none in a motion without inertia", "some")),
            };
        }
        let held = self.held();
        for (p, &mass) in self.masses.iter().enumerate() {
            let moves = held[p * d..(p + 1) * d].contains(&false);
            // A point that is held on all axes needs no mass; a quadratic element may lump zero on it.
            if !(mass.is_finite() && (mass > 0.0 || mass == 0.0 && !moves)) {
                let expected = format!("a mass above zero at point {p} (HRZ lumping gives one)");
                return Err(Error::expected("masses", expected, mass));
            }
        }
        Ok(())
    }
}

impl fmt::Debug for Motion<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Motion")
            .field("points", &self.masses.len())
            .field("damping", &self.damping)
            .finish_non_exhaustive()
    }
}

/// How a motion is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The time step, s.
    pub step: f64,
    /// The integration method.
    pub integrator: Integrator,
    /// The largest number of Newton iterations in an implicit step. With 1 the step is linearised, and its residual is
    /// not computed.
    pub iterations: usize,
    /// The largest residual of an implicit step, relative to the forces that act.
    pub tolerance: f64,
    /// Whether the model is linear, `F(x) ≈ F₀ + K₀ u`, with springs and dampers as they are at rest. Then all steps
    /// have the same matrix.
    pub linear: bool,
    /// Whether inertia is left out: every state is in equilibrium, `F(x) = f(t)`, from the first on, which is that of the loads at time zero.
    /// Masses then count for gravity alone.
    pub quasi_static: bool,
    /// Without inertia, the error of a step that is allowed, as a share of the largest displacement; a step is divided until its estimate is
    /// smaller. `None` for steps that are not divided.
    pub error: Option<f64>,
    /// The solver of the linear equations of implicit steps.
    pub solver: LinearSolver,
    /// Whether work and dissipation are summed; this costs the forces at the end of a step if they are not computed
    /// anyway.
    pub account: bool,
}

impl Default for Options {
    fn default() -> Options {
        let (integrator, solver) = (Integrator::default(), LinearSolver::default());
        Options {
            step: 0.01,
            integrator,
            iterations: 20,
            tolerance: 1e-10,
            linear: false,
            quasi_static: false,
            error: None,
            solver,
            account: true,
        }
    }
}

impl Options {
    /// The name of the method: that of the integrator, or `quasi-static` without inertia.
    pub fn method(&self) -> &'static str {
        if self.quasi_static { "quasi-static" } else { self.integrator.name() }
    }

    pub(super) fn check(&self) -> Result<()> {
        if !(self.step > 0.0 && self.step.is_finite()) {
            return Err(Error::expected("step", "a time above zero in s", self.step));
        }
        if self.iterations == 0 {
            return Err(Error::expected("iterations", "at least one", 0));
        }
        // The comparison is negated, so that NaN is refused too.
        if !(self.tolerance > 0.0) {
            return Err(Error::expected("tolerance", "a number above zero", self.tolerance));
        }
        if self.quasi_static && self.integrator != Integrator::ImplicitEuler {
            let found = format!("\"{}\"", self.integrator.name());
            return Err(Error::expected("integrator", "none in a motion without inertia", found));
        }
        if let Some(error) = self.error {
            if !self.quasi_static {
                return Err(Error::at("error", "belongs to motions without inertia"));
            }
            if !(error > 0.0 && error < 1.0) {
                return Err(Error::expected("error", "a share above 0 and below 1", error));
            }
        }
        self.solver.check()?;
        self.integrator.check()
    }
}
