//! Loads at large deformation: each is made as large as it takes to stretch the body as far as is wanted.
//!
//! A load `t f` is followed from rest along its factor t, with `K⁻¹ f` as predictor. The next factor is where the stretch would be the wanted
//! one if it went on along its last secant; where no stable equilibrium is found, or the body jumps beyond the wanted stretch, the step is
//! shortened.
//!
//! Theory: page *Whole-object fits* of the book.

use super::loads::NodalLoad;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::model::{Deformation, Elastic, Support};
use crate::solve::{Equations, Newton, System};
use rayon::prelude::*;
use std::sync::Arc;

/// The share of the body that is stretched at least as far as is wanted.
// The largest stretch is that of the cells at the edges of supports, and grows as they become smaller. These cells are far less than
// a tenth of the body.
const SHARE: f64 = 0.1;
/// The relative difference from the wanted stretch that counts as none: errors of coarse bodies hardly change with it.
// A fourth of this difference takes 13 % more equilibria for the loads of a bar of hexahedra at 30 %, and four times as
// much takes 19 % fewer.
const NEAR: f64 = 0.05;
/// A load that leaves less than this share of the wanted stretch says little of large deformation, and is left out.
// What laws differ by at large deformation is of the second order in the stretch: a fourth is left at half of it.
const LEAST: f64 = 0.5;
/// Equilibria that are sought at most for a load. Where they do not suffice, the load counts as far as it was followed.
const SOLUTIONS: usize = 20;
/// Iterations at most for one of them: where Newton's method takes more, a shorter step is cheaper.
const ITERATIONS: usize = 25;
/// The first step, as a share of the factor at which the linear body has the wanted stretch.
// Shares of 0.25 to 2 take as many equilibria there to 17 %, and an eighth takes a quarter more.
const FIRST: f64 = 0.5;
/// Shorter steps, as a share of the same factor, end the search.
// With 0.08 six of 43 loads of that bar end before the wanted stretch, which they reach with 0.02.
const SHORTEST: f64 = 0.02;
/// The share of its last factor to which a load is scaled back that has lost its equilibrium: at the limit itself the displacements have no
/// bound, and say nothing of a model.
// Where a path turns back, displacements are away from those at the limit by the root of what the factor lacks, `√(1 − t)`: they grow
// with the load three times as fast at 0.9 of it as at rest.
const BACK: f64 = 0.9;
/// The strain at which the linear stretch is taken: rotations do not show in it.
// A rotation a hundred times as large as the strain adds half of its square, 5e-9, to a stretch of 1e-6. Rounding of `Fᵀ F` is 1e-10
// of the strain.
const SMALL: f64 = 1e-6;
/// Draws of a random load at most.
// Each draw takes up to twenty equilibria. A note names a load that is left out because the body gives way under every draw.
const DRAWS: u64 = 4;

/// Makes the loads of a set; those that are drawn at random are others in each draw.
pub type MakeLoads<'a> = dyn Fn(u64) -> Vec<NodalLoad> + 'a;

/// A body that is stretched by loads.
pub struct Stretched<'a> {
    /// Its finite elements.
    pub model: &'a (dyn Elastic + Sync),
    /// Its mesh.
    pub mesh: &'a Mesh,
    /// How equilibria are found.
    pub newton: Newton,
    /// The stretch that is wanted in a tenth of the body: 0.3 where it becomes longer or shorter by 30 %.
    pub stretch: f64,
}

/// Loads that stretch a body, and its displacements under them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StretchedLoads {
    /// The loads, and the displacements, `[points · dimension]`, m.
    pub loads: Vec<(NodalLoad, Vec<f64>)>,
    /// Those among them whose equilibrium was lost before the wanted stretch, and the stretch to which they were scaled back.
    pub back: Vec<(String, f64)>,
    /// Those among them that were drawn anew, because the first draw lost its equilibrium before half of the stretch.
    pub anew: Vec<String>,
    /// The loads that are left out, because no draw reached half of the stretch.
    pub out: Vec<String>,
}

/// How far a load was followed.
struct Followed {
    factor: f64,
    stretch: f64,
    displacement: Vec<f64>,
    /// The equations of the tangent there.
    equations: Equations,
}

impl Stretched<'_> {
    /// The loads that `make` makes, each scaled until the body has the wanted stretch.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn loads(&self, support: &Support, make: &MakeLoads) -> Result<StretchedLoads> {
        let first = make(0);
        let Some(rest) = self.model.respond(&self.mesh.points) else { return Ok(StretchedLoads::default()) };
        let pattern = Newton::pattern(&rest.tangent, support)?.placed(&self.mesh.points, self.mesh.dimension);
        let at_rest = Equations::of_system(Arc::new(Newton::equations(&pattern, &rest.tangent, support)?))?;
        let Some(at_rest) = at_rest else { return Ok(StretchedLoads::default()) };
        let follow = |load: &NodalLoad| self.follow(&load.forces, support, &at_rest, &pattern);
        // Loads know nothing of each other and stay in their order: threads change no bit of the result.
        let followed: Vec<Option<Followed>> = first.par_iter().map(follow).collect::<Result<_>>()?;
        let mut all = StretchedLoads::default();
        for (load, followed) in first.into_iter().zip(followed) {
            let (mut load, mut best) = (load, followed);
            for draw in 1..DRAWS {
                if best.as_ref().is_some_and(|found| found.stretch >= LEAST * self.stretch) {
                    break;
                }
                let again = make(draw).into_iter().find(|other| other.name == load.name && other.forces != load.forces);
                // A load without chance in it is the same in each draw.
                let Some(again) = again else { break };
                best = follow(&again)?;
                load = again;
                if !all.anew.contains(&load.name) {
                    all.anew.push(load.name.clone());
                }
            }
            let Some(found) = best.filter(|found| found.stretch >= LEAST * self.stretch) else {
                // The last draw has failed as well. The report names the load once, among those that are left out.
                all.anew.retain(|name| *name != load.name);
                all.out.push(load.name);
                continue;
            };
            if found.stretch < (1.0 - NEAR) * self.stretch {
                all.back.push((load.name.clone(), found.stretch));
            }
            load.forces.iter_mut().for_each(|f| *f *= found.factor);
            all.loads.push((load, found.displacement));
        }
        Ok(all)
    }

    /// Follows `t f` to the wanted stretch, or as far as there is a stable equilibrium; `None` if there is none.
    fn follow(&self, f: &[f64], support: &Support, at_rest: &Equations, pattern: &System) -> Result<Option<Followed>> {
        let Some(linear) = at_rest.respond_all(std::slice::from_ref(&f.to_vec()), 0.0)?.pop() else { return Ok(None) };
        let strain = Deformation::largest(self.mesh, &linear).strain;
        if !(strain > 0.0 && strain.is_finite()) {
            return Ok(None);
        }
        // A linear body under a unit load may turn and stretch without bound, and its stretch would mean nothing.
        let small: Vec<f64> = linear.iter().map(|u| SMALL / strain * u).collect();
        // Where the linear body has the wanted stretch.
        let whole = self.stretch * SMALL / strain / self.stretch(&small);
        if !(whole > 0.0 && whole.is_finite()) {
            return Ok(None);
        }
        let rest = vec![0.0; f.len()];
        let mut now = Followed { factor: 0.0, stretch: 0.0, displacement: rest, equations: at_rest.clone() };
        let (mut step, mut ahead) = (FIRST * whole, linear);
        for _ in 0..SOLUTIONS {
            let factor = now.factor + step;
            let guess: Vec<f64> = now.displacement.iter().zip(&ahead).map(|(u, v)| u + step * v).collect();
            match self.settled(f, factor, &guess, support, pattern)? {
                Some(found) if found.stretch <= (1.0 + NEAR) * self.stretch => {
                    if found.stretch >= (1.0 - NEAR) * self.stretch {
                        return Ok(Some(found));
                    }
                    let missing = (self.stretch - found.stretch) / (found.stretch - now.stretch);
                    // A body that stiffens would be sent far ahead by its last secant: no step is more than twice the
                    // one before.
                    step *= if missing > 0.0 { missing.min(2.0) } else { 1.0 };
                    ahead =
                        found.equations.respond_all(std::slice::from_ref(&f.to_vec()), 0.0)?.pop().unwrap_or_default();
                    now = found;
                }
                // Too far, or by a jump.
                Some(found) => {
                    let share = (self.stretch - now.stretch) / (found.stretch - now.stretch);
                    // At least a tenth, because behind a jump the secant says nothing; at most nine tenths, so that the
                    // step becomes shorter.
                    step *= share.clamp(0.1, 0.9);
                }
                None => step /= 2.0,
            }
            if step < SHORTEST * whole {
                break;
            }
        }
        // Not one equilibrium was found on the way from rest.
        if now.factor == 0.0 {
            return Ok(None);
        }
        let guess: Vec<f64> = now.displacement.iter().map(|u| BACK * u).collect();
        self.settled(f, BACK * now.factor, &guess, support, pattern)
    }

    /// The stable equilibrium under `t f` near a guess.
    fn settled(
        &self,
        f: &[f64],
        factor: f64,
        guess: &[f64],
        support: &Support,
        pattern: &System,
    ) -> Result<Option<Followed>> {
        let forces: Vec<f64> = f.iter().map(|f| factor * f).collect();
        let newton = Newton { iterations: self.newton.iterations.min(ITERATIONS), ..self.newton };
        let found = newton.settle_stable(self.model, &self.mesh.points, support, &forces, guess, pattern)?;
        Ok(found.map(|(displacement, equations)| {
            let stretch = self.stretch(&displacement);
            Followed { factor, stretch, displacement, equations }
        }))
    }

    fn stretch(&self, u: &[f64]) -> f64 {
        Deformation::stretch_of(self.mesh, u, SHARE)
    }
}
