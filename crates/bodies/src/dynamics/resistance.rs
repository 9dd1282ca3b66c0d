//! The elastic forces, damping and inertia of a model in motion.

use super::damping::Damping;
use super::equations::Equations;
use super::memory::Memory;
use super::motion::Motion;
use super::pass;
use super::rest::Rest;
use super::solver::LinearSolver;
use crate::error::Result;
use crate::model::Elastic;
use crate::solve::rounding;

/// `F(x)`, `C` and `M` of a motion, on all degrees of freedom.
pub(super) struct Resistance<'a> {
    model: &'a dyn Elastic,
    points: &'a [f64],
    pub rest: Rest,
    /// Whether the model is replaced by `F₀ + K₀ u`.
    linear: bool,
    /// Stress that relaxes, and the number of entries of the tangent before those that it adds.
    memory: Option<Memory>,
    elastic_entries: usize,
    damping: Damping,
    /// The gradients of the dampers, where they were last computed.
    gradients: Vec<f64>,
    damper_entries: Vec<f64>,
    /// The mass of each degree of freedom, kg.
    pub mass: Vec<f64>,
    pub held: Vec<bool>,
    /// The largest coordinate, m.
    pub extent: f64,
    x: Vec<f64>,
    /// The sum of the squares of the elastic forces before those of relaxing stress are added, N².
    pub apart: f64,
}

impl<'a> Resistance<'a> {
    /// Prepares the forces, the damping and the masses of a motion; `has_equations` tells whether its method has equations to solve.
    pub fn new(motion: &Motion<'a>, linear: bool, has_equations: bool) -> Result<Resistance<'a>> {
        let d = motion.dimension();
        let rest = Rest::new(motion.model, motion.points, motion.memory.as_ref(), has_equations)?;
        let remembered = motion.memory.as_ref().map_or(0, |memory| memory.places().len());
        let mut resistance = Resistance {
            model: motion.model,
            points: motion.points,
            memory: motion.memory.clone(),
            elastic_entries: rest.values().len() - remembered,
            rest,
            linear,
            damping: motion.damping.clone(),
            gradients: Vec::new(),
            damper_entries: Vec::new(),
            mass: motion.masses.iter().flat_map(|m| std::iter::repeat_n(*m, d)).collect(),
            held: motion.held(),
            extent: motion.points.iter().fold(0.0, |extent, x| extent.max(x.abs())),
            x: motion.points.to_vec(),
            apart: 0.0,
        };
        resistance.direct(&vec![0.0; motion.points.len()], true);
        Ok(resistance)
    }

    /// Turns the dampers along the gradients at the displacements u. In a linear model they stay as at rest, unless
    /// `anyway` is set.
    pub fn direct(&mut self, u: &[f64], anyway: bool) {
        if !self.has_dampers() || !anyway && self.linear {
            return;
        }
        self.place(u);
        if let Some(dampers) = &self.damping.dampers {
            dampers.gradients(&self.x, &mut self.gradients);
            dampers.entries(&self.gradients, &mut self.damper_entries);
        }
    }

    pub fn has_dampers(&self) -> bool {
        self.damping.dampers.is_some()
    }

    /// Whether anything opposes velocities.
    pub fn is_damped(&self) -> bool {
        self.damping.mass > 0.0 || self.damping.stiffness > 0.0 || self.has_dampers()
    }

    fn place(&mut self, u: &[f64]) {
        pass::place(&mut self.x, self.points, u);
    }

    /// Forgets everything that was before the displacements u; false if there is no response.
    pub fn reset(&mut self, u: &[f64]) -> bool {
        self.memory.as_mut().is_none_or(|memory| memory.reset(u))
    }

    /// Prepares the memory for explicit steps of this length, s.
    pub fn expect_explicit(&mut self, step: f64) {
        self.memory = self.memory.take().map(|memory| memory.for_explicit(step));
    }

    /// Sets the length of the step at whose end forces are computed, s; zero for the present ones.
    pub fn prepare(&mut self, step: f64) {
        if let Some(memory) = &mut self.memory {
            memory.prepare(step);
        }
    }

    /// Ends the step that was prepared at the displacements u.
    pub fn advance(&mut self, u: &[f64]) {
        if let Some(memory) = &mut self.memory {
            memory.advance(u);
        }
    }

    /// What is remembered.
    pub fn memory(&self) -> Option<&Memory> {
        self.memory.as_ref()
    }

    /// Remembers what was before.
    pub fn remember(&mut self, memory: Option<Memory>) {
        self.memory = memory;
    }

    /// What relaxing stress has dissipated, J.
    pub fn relaxed(&self) -> f64 {
        self.memory.as_ref().map_or(0.0, Memory::dissipated)
    }

    /// The entries of the tangent of a linear model, for the step that is prepared.
    pub fn linear_tangent(&self) -> Vec<f64> {
        let mut values = self.rest.values().to_vec();
        if let Some(memory) = &self.memory {
            // The tangent of a linear memory does not depend on the displacements.
            let still = vec![0.0; self.points.len()];
            memory.add(&still, &mut vec![0.0; still.len()], Some(&mut values[self.elastic_entries..]));
        }
        values
    }

    /// The gradient of the energy at the displacements u, N; false if there is none.
    pub fn forces(&mut self, u: &[f64], force: &mut [f64]) -> bool {
        let is_known = match self.linear {
            true => self.rest.refill(u, force).is_finite(),
            false => {
                self.place(u);
                self.model.forces(&self.x, force)
            }
        };
        let mut is_remembered = |force: &mut [f64]| match &mut self.memory {
            Some(memory) => memory.pull(u, force),
            None => true,
        };
        is_known && is_remembered(force) && pass::all(force, f64::is_finite)
    }

    /// Writes the gradient of the energy at the displacements u, N, and the values of the entries of the tangent, or of a nearby positive
    /// semidefinite one if `definite`. Returns the energy, J.
    pub fn refill(&mut self, u: &[f64], force: &mut [f64], tangent: &mut [f64], definite: bool) -> Option<f64> {
        self.place(u);
        // Of all entries those of the model come first, and those of what relaxes after them, as in `Rest`.
        let (elastic, remembered) = tangent.split_at_mut(self.elastic_entries);
        let mut energy = match definite {
            true => self.model.refill_definite(&self.x, force, elastic)?,
            false => self.model.refill(&self.x, force, elastic)?,
        };
        if let Some(memory) = &self.memory {
            self.apart = force.iter().map(|f| f * f).sum();
            energy += memory.add(u, force, Some(remembered))?;
        }
        // One sum shows any force that is not finite.
        (energy + force.iter().sum::<f64>()).is_finite().then_some(energy)
    }

    /// A bound of the rounding errors of the elastic forces at the displacements u on these degrees of freedom, in the Euclidean norm, N, by the stiffness at rest.
    pub fn rounding(&mut self, u: &[f64], order: &[usize]) -> f64 {
        self.place(u);
        let bound = rounding(self.rest.entries(), &self.x);
        order.iter().map(|&dof| bound[dof].powi(2)).sum::<f64>().sqrt()
    }

    /// The elastic energy beyond that at rest, J.
    pub fn energy(&mut self, u: &[f64]) -> Option<f64> {
        let remembered = match &self.memory {
            Some(memory) => memory.stored(u)?,
            None => 0.0,
        };
        if self.linear {
            let mut force = vec![0.0; u.len()];
            return Some(self.rest.refill(u, &mut force) + remembered);
        }
        self.place(u);
        // A spring with the rest length zero stores energy at rest. The energy of the motion does not include it.
        Some(self.model.energy(&self.x)? + remembered - self.rest.energy)
    }

    /// `C v`, N.
    pub fn viscous(&self, v: &[f64], forces: &mut [f64]) {
        let Damping { mass, stiffness, dampers } = &self.damping;
        forces.iter_mut().zip(v).zip(&self.mass).for_each(|((f, v), m)| *f = mass * m * v);
        if *stiffness > 0.0 {
            self.rest.add_product(*stiffness, v, forces);
        }
        if let Some(dampers) = dampers {
            dampers.add_forces(&self.gradients, v, forces);
        }
    }

    /// The equations of implicit steps.
    ///
    /// # Errors
    /// They do not fit into memory.
    pub fn equations(&self, motion: &Motion, solver: LinearSolver) -> Result<Box<dyn Equations>> {
        solver.equations(&self.places(), &self.held, motion.points, motion.dimension())
    }

    /// The positions of the entries of K and then of those of the dampers.
    pub fn places(&self) -> Vec<(usize, usize)> {
        let dampers = self.damping.dampers.iter().flat_map(|dampers| dampers.places());
        self.rest.entries().iter().map(|e| (e.row.max(e.col), e.row.min(e.col))).chain(dampers).collect()
    }

    /// `A = c₂ M + c₁ C + K`.
    pub fn assemble(&self, [c1, c2]: [f64; 2], tangent: &[f64], equations: &mut dyn Equations) {
        let share = c2 + c1 * self.damping.mass;
        equations.set_diagonal(&|dof| share * self.mass[dof]);
        equations.add(0, 1.0, tangent);
        if self.damping.stiffness > 0.0 {
            equations.add(0, c1 * self.damping.stiffness, self.rest.values());
        }
        if self.damping.dampers.is_some() {
            equations.add(tangent.len(), c1, &self.damper_entries);
        }
    }

    /// Upper bounds of the eigenvalues of `M⁻¹K`, rad²/s², and `M⁻¹C`, 1/s, at rest.
    pub fn largest(&self) -> [f64; 2] {
        let square = self.rest.largest_square(&self.mass, &self.held);
        let mut damping = self.damping.mass + self.damping.stiffness * square;
        if let Some(dampers) = &self.damping.dampers {
            let places: Vec<(usize, usize)> = dampers.places().collect();
            let entries = places.iter().zip(&self.damper_entries).map(|((row, column), c)| (*row, *column, *c));
            // The largest eigenvalue of a sum is at most the sum of the largest ones: the step is rather too short.
            damping += super::largest_square(entries, &self.mass, &self.held);
        }
        [square, damping]
    }
}

impl std::fmt::Debug for Resistance<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Resistance")
            .field("damping", &self.damping)
            .field("linear", &self.linear)
            .finish_non_exhaustive()
    }
}
