//! The end of an implicit step: Newton's method on `M a + C v + F(x) = f`.
//!
//! Theory: page *Dynamics* of the book.

use super::equations::{End, Equations};
use super::resistance::Resistance;
use crate::solve::ROUGHEST;
use springfit_numerics::newton::{falls_enough, shifts};

/// The largest number of halvings of a Newton step. Where a step of a millionth does not decrease the potential, the
/// state is kept as it was, and the step has stalled.
const HALVINGS: usize = 20;
/// A Newton step below this share of the model's coordinates is within their rounding: no better solution exists.
const ROUNDING: f64 = 1e-14;

/// How a step ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepOutcome {
    /// The equations hold to the tolerance. Steps of explicit methods always end so, and so do those of linear models.
    Converged,
    /// One iteration was allowed, and made.
    Linearized,
    /// The iterations (of Newton's method, or of conjugate gradients if the step is a single solution) did not suffice,
    /// or no Newton step decreased the potential. The motion continues from the best state that was found.
    Stalled,
    /// The model has no response at the end of the step, for example because a cell is inverted. The state and its time
    /// are unchanged.
    NoResponse,
}

/// The outcome of one step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// How the step ended.
    pub outcome: StepOutcome,
    /// The number of Newton iterations.
    pub iterations: usize,
    /// The residual of the equations, relative to the forces that act; `None` if it was not computed: for linearised
    /// steps and linear models.
    pub residual: Option<f64>,
    /// The number of iterations whose matrix was not positive definite and was modified. A linearised step of a model that does not pull at rest uses
    /// a definite matrix from the start.
    pub modified: usize,
    /// The total number of iterations of conjugate gradients.
    pub solver_iterations: usize,
}

impl Step {
    /// Describes the end of a step that solves no equations.
    pub(super) fn explicit(outcome: StepOutcome) -> Step {
        Step { outcome, iterations: 0, residual: None, modified: 0, solver_iterations: 0 }
    }
}

/// The unknown of a step, Δ = x − x_n, and the data at its end; all `[points · dimension]`.
#[derive(Debug)]
pub(super) struct Target {
    /// `v = c₁ (Δ − ẑ)`, `a = c₂ (Δ − ŷ)` of the free degrees of freedom.
    pub coefficients: [f64; 2],
    pub z: Vec<f64>,
    pub y: Vec<f64>,
    /// Δ, m; for held degrees of freedom it is known.
    pub delta: Vec<f64>,
    /// The velocity, m/s; for held degrees of freedom it is known.
    pub velocity: Vec<f64>,
    /// f at the end of the step, N.
    pub external: Vec<f64>,
}

/// Entries of two tangents that are as near as this, relative to the largest, differ by rounding.
// Sums over the springs of a point are rounded by some 1e-15. Where springs pull at rest, the definite tangent
// lacks their pull over their length. A difference below the bound changes no printed digit of a displacement.
const ALIKE: f64 = 1e-9;

/// What is computed besides the forces.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Tangent {
    None,
    Exact,
    /// Positive semidefinite, if the model provides it.
    Definite,
}

/// The terms of the equations at one Δ.
#[derive(Debug)]
pub(super) struct Trial {
    /// ∂U/∂x, N.
    pub force: Vec<f64>,
    pub tangent: Vec<f64>,
    /// `C v`, N.
    viscous: Vec<f64>,
    /// `f − F − C v − M a` on the free degrees of freedom, in the order of the equations.
    residual: Vec<f64>,
    /// `U − f·Δ + c₂/2 (Δ − ŷ)ᵀM(Δ − ŷ) + vᵀCv/2c₁`, J; the residual is its negative gradient.
    potential: f64,
    /// The norm of the residual, relative to the forces that act.
    size: f64,
    u: Vec<f64>,
    step: Vec<f64>,
    tried: Vec<f64>,
    /// Whether the definite tangent is the exact one at rest.
    is_definite_at_rest: bool,
}

impl Trial {
    pub fn new(dofs: usize, free: usize, entries: usize) -> Trial {
        let [force, viscous, u, tried] = std::array::from_fn(|_| vec![0.0; dofs]);
        let [residual, step] = std::array::from_fn(|_| vec![0.0; free]);
        Trial {
            force,
            tangent: vec![0.0; entries],
            viscous,
            residual,
            potential: 0.0,
            size: 0.0,
            u,
            step,
            tried,
            is_definite_at_rest: true,
        }
    }

    /// Learns whether the definite tangent of a model is the exact one at rest, `values`. It is not where springs pull at rest: there the forces of
    /// contents are a part of the stiffness, which it leaves out.
    pub fn compare_tangents(&mut self, resistance: &mut Resistance, values: &[f64]) {
        self.u.fill(0.0);
        let is_known = resistance.refill(&self.u, &mut self.force, &mut self.tangent, true).is_some();
        let largest = values.iter().fold(0.0f64, |largest, k| largest.max(k.abs()));
        let is_alike = |(a, b): (&f64, &f64)| (a - b).abs() <= ALIKE * largest;
        self.is_definite_at_rest = is_known && self.tangent.iter().zip(values).all(is_alike);
    }

    /// Evaluates the equations at the Δ of `target`, from displacements `start`; false if the model has no response.
    fn evaluate(
        &mut self,
        resistance: &mut Resistance,
        target: &mut Target,
        start: &[f64],
        order: &[usize],
        tangent: Tangent,
    ) -> bool {
        let [c1, c2] = target.coefficients;
        self.u.iter_mut().zip(start).zip(&target.delta).for_each(|((u, s), d)| *u = s + d);
        let energy = match tangent {
            Tangent::None => resistance.forces(&self.u, &mut self.force).then_some(0.0),
            kind => resistance.refill(&self.u, &mut self.force, &mut self.tangent, kind == Tangent::Definite),
        };
        let Some(energy) = energy else { return false };
        order.iter().for_each(|&dof| target.velocity[dof] = c1 * (target.delta[dof] - target.z[dof]));
        resistance.viscous(&target.velocity, &mut self.viscous);
        let (mut kinetic, mut work, mut left, mut acting) = (0.0, 0.0, 0.0, [0.0; 4]);
        for (r, &dof) in self.residual.iter_mut().zip(order) {
            let off = target.delta[dof] - target.y[dof];
            // The residual is measured against all four, because any two of them may balance while the others are
            // small.
            let parts = [target.external[dof], self.force[dof], self.viscous[dof], c2 * resistance.mass[dof] * off];
            *r = parts[0] - parts[1] - parts[2] - parts[3];
            left += *r * *r;
            acting.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part * part);
            kinetic += parts[3] * off;
            work += parts[0] * target.delta[dof];
        }
        if c2 == 0.0 {
            // Without inertia and loads what acts are the forces of held points, and stress that relaxes against what is elastic.
            acting[1] = self.force.iter().map(|f| f * f).sum::<f64>().max(resistance.apart);
        }
        // All degrees of freedom, since dampers between held and free points oppose both.
        let drag: f64 = target.velocity.iter().zip(&self.viscous).map(|(v, f)| v * f).sum();
        let acting: f64 = acting.iter().map(|square| square.sqrt()).sum();
        // A damper pulls with `D v`, and `v = c₁ (Δ − z)`: its potential is half of `D v (Δ − z)`, which is `v D v/(2
        // c₁)`.
        self.potential = energy - work + kinetic / 2.0 + drag / (2.0 * c1);
        // A body at rest without loads has 0/0.
        self.size = if left == 0.0 { 0.0 } else { left.sqrt() / acting };
        self.potential.is_finite() && self.size.is_finite()
    }

    /// Computes the Newton step, with a definite tangent if the exact one makes the matrix indefinite, or with the
    /// smallest sufficient addition to the diagonal if that is not available. `None` if ten times the diagonal is not
    /// enough.
    fn direction(
        &mut self,
        resistance: &mut Resistance,
        target: &Target,
        equations: &mut dyn Equations,
        made: &mut Step,
        is_only: bool,
    ) -> Option<End> {
        resistance.assemble(target.coefficients, &self.tangent, equations);
        // If no line search follows, a solution may start anywhere; the iterates from zero are all descent directions.
        let guess = is_only.then_some(&target.y[..]);
        let mut end = self.solve(equations, guess, made);
        if end == End::Indefinite {
            made.modified += 1;
            resistance.refill(&self.u, &mut self.force, &mut self.tangent, true);
            resistance.assemble(target.coefficients, &self.tangent, equations);
            end = self.solve(equations, None, made);
            let mut last = 0.0;
            for shift in shifts() {
                if end != End::Indefinite {
                    break;
                }
                // What the last trial has added is in the matrix already.
                equations.shift(shift - last);
                last = shift;
                end = self.solve(equations, None, made);
            }
        }
        (end != End::Indefinite && self.step.iter().sum::<f64>().is_finite()).then_some(end)
    }

    fn solve(&mut self, equations: &mut dyn Equations, guess: Option<&[f64]>, made: &mut Step) -> End {
        if !equations.prepare() {
            return End::Indefinite;
        }
        self.step.copy_from_slice(&self.residual);
        let solved = equations.solve(&mut self.step, guess);
        made.solver_iterations += solved.iterations;
        solved.end
    }

    /// A linear model: one solution with the prepared matrix.
    pub fn solve_linear(
        &mut self,
        resistance: &mut Resistance,
        target: &mut Target,
        start: &[f64],
        equations: &mut dyn Equations,
    ) -> Step {
        let mut step =
            Step { outcome: StepOutcome::NoResponse, iterations: 1, residual: None, modified: 0, solver_iterations: 0 };
        if !self.evaluate(resistance, target, start, equations.order(), Tangent::None) {
            return step;
        }
        let solved = equations.solve(&mut self.residual, Some(&target.y));
        step.solver_iterations = solved.iterations;
        equations.order().iter().zip(&self.residual).for_each(|(&dof, s)| target.delta[dof] += s);
        if self.residual.iter().sum::<f64>().is_finite() {
            // A linear model has its answer after one solution, unless iterations ended before it.
            step.outcome = if solved.end == End::Exact { StepOutcome::Converged } else { StepOutcome::Stalled };
        }
        step
    }

    /// Newton's method with a line search on the potential, starting at Δ. The potential decreases with every
    /// iteration, so that implicit Euler loses energy even if the iterations do not suffice.
    pub fn settle(
        &mut self,
        resistance: &mut Resistance,
        target: &mut Target,
        start: &[f64],
        equations: &mut dyn Equations,
        iterations: usize,
        tolerance: f64,
    ) -> Step {
        let mut made =
            Step { outcome: StepOutcome::Stalled, iterations: 0, residual: None, modified: 0, solver_iterations: 0 };
        // A single step cannot be corrected. Of a model that does not pull at rest either tangent is accurate to first order in the strain.
        let is_definite = iterations == 1 && self.is_definite_at_rest;
        let tangent = if is_definite { Tangent::Definite } else { Tangent::Exact };
        if !self.evaluate(resistance, target, start, equations.order(), tangent) {
            return Step { outcome: StepOutcome::NoResponse, ..made };
        }
        made.residual = Some(self.size);
        while made.iterations < iterations {
            if self.size <= tolerance {
                break;
            }
            let Some(end) = self.direction(resistance, target, equations, &mut made, iterations == 1) else {
                return made;
            };
            made.iterations += 1;
            if iterations == 1 {
                equations.order().iter().zip(&self.step).for_each(|(&dof, s)| target.delta[dof] += s);
                let outcome = if end == End::Exact { StepOutcome::Linearized } else { StepOutcome::Stalled };
                return Step { outcome, residual: None, ..made };
            }
            let (potential, size) = (self.potential, self.size);
            let slope: f64 = self.residual.iter().zip(&self.step).map(|(r, s)| r * s).sum();
            let longest = self.step.iter().fold(0.0f64, |longest, s| longest.max(s.abs()));
            let is_rounding = longest <= ROUNDING * resistance.extent;
            self.tried.copy_from_slice(&target.delta);
            let mut length = 1.0;
            let accepted = (0..HALVINGS).any(|_| {
                for (&dof, s) in equations.order().iter().zip(&self.step) {
                    target.delta[dof] = self.tried[dof] + length * s;
                }
                let is_known = self.evaluate(resistance, target, start, equations.order(), Tangent::Exact);
                let falls = falls_enough(potential, self.potential, -length * slope);
                length /= 2.0;
                // Near the solution the rounding of the potential hides its decrease.
                is_known && (falls || is_rounding || self.size < 0.5 * size)
            });
            if !accepted {
                // Back to where the step began, since all shorter ones are worse.
                target.delta.copy_from_slice(&self.tried);
                self.evaluate(resistance, target, start, equations.order(), Tangent::Exact);
                return self.ended(resistance, equations.order(), made);
            }
            made.residual = Some(self.size);
            if is_rounding {
                return Step { outcome: StepOutcome::Converged, ..made };
            }
        }
        if self.size <= tolerance {
            made.outcome = StepOutcome::Converged;
        }
        made
    }

    /// A step that no Newton step makes better, whose residual is above the tolerance. It has converged if the residual is within the rounding errors of the elastic forces, and these are small
    /// beside what acts: slender rods are so much stiffer along than across that no state is better.
    fn ended(&self, resistance: &mut Resistance, order: &[usize], made: Step) -> Step {
        let left = self.residual.iter().map(|r| r * r).sum::<f64>().sqrt();
        // The size is the residual over what acts, so that this quotient is what acts; it is above zero, as the size is
        // above the tolerance.
        let (bound, acting) = (resistance.rounding(&self.u, order), left / self.size);
        let is_rounding = left <= bound && bound <= ROUGHEST * acting;
        Step { outcome: if is_rounding { StepOutcome::Converged } else { made.outcome }, ..made }
    }
}
