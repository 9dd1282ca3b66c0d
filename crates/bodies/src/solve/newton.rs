//! Statics at large deformation: Newton's method with load steps and a line search, for finite elements or a network.
//!
//! Theory: page *Precision* of the book.

use super::applied::{Applied, Following};
use super::internal::{Form, Internal, Rest, masked};
use super::linear::System;
use crate::error::Result;
use crate::model::{Elastic, Entries, Support};
use crate::springs::{dot, norm};
use faer::sparse::Triplet;
use serde::{Deserialize, Serialize};
use springfit_numerics::newton::{falls_enough, shifts};
use std::borrow::Cow;

/// How a load is applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newton {
    /// The number of load steps at the start; a step that fails is halved.
    pub steps: usize,
    /// The largest number of iterations in one step.
    pub iterations: usize,
    /// The largest residual, relative to the forces that act. If their rounding error is larger, it is used instead, up
    /// to 1e-4.
    pub tolerance: f64,
}

impl Default for Newton {
    fn default() -> Newton {
        // Where Newton's method takes more iterations, two shorter load steps are cheaper.
        Newton { steps: 1, iterations: 40, tolerance: 1e-10 }
    }
}

/// How a solution ended. In JSON it is true or false.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "bool", into = "bool")]
pub enum Ending {
    /// The whole load is in equilibrium.
    Converged,
    /// A load step failed even after it was halved as often as allowed.
    Stalled,
}

impl From<bool> for Ending {
    fn from(converged: bool) -> Ending {
        if converged { Ending::Converged } else { Ending::Stalled }
    }
}

impl From<Ending> for bool {
    fn from(ending: Ending) -> bool {
        ending == Ending::Converged
    }
}

/// An equilibrium, or the last one that was found.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Equilibrium {
    /// Whether the whole load was reached.
    pub ending: Ending,
    /// The displacements, `[points · dimension]`, m.
    pub displacement: Vec<f64>,
    /// The displacements at the loads on the way. The last one is `displacement`, if any load was reached.
    pub path: Vec<Vec<f64>>,
    /// The share of the load that is applied, 1 if converged.
    pub load: f64,
    /// The residuals of the iterations of each step, relative to the forces that act.
    pub residuals: Vec<Vec<f64>>,
    /// The number of iterations whose tangent was not positive definite and was shifted.
    pub shifted: usize,
    /// Whether the equilibrium is accurate only to the rounding of the forces, which exceeds the tolerance.
    pub is_rounded: bool,
    /// The pressures in a cavity that is filled at the volumes on the way, as `path`, Pa; else empty.
    pub pressures: Vec<f64>,
}

/// The largest rounding error of the forces, relative to the applied forces, at which a balance of forces counts as an
/// equilibrium. Beyond it the displacements would have less than four digits, which no report could show as a solution.
pub(crate) const ROUGHEST: f64 = 1e-4;
/// Forces of all points, held ones too, that exceed the bound of the rounding of the free ones by no more than this are none.
// Both are Euclidean norms. Roundings that are alike at all points exceed those of the free ones by the root of the
// quotient of the two numbers, which is 10 where one degree of freedom in a hundred is free.
const RIGID: f64 = 10.0;
/// The relative accuracy to which prescribed displacements are reached. The last part of a displacement is added to the
/// others, whose rounding it leaves.
const REACHED: f64 = 1e-14;
/// The largest number of halvings of a load step. A load that does not advance by 1/256 of a step has reached a limit,
/// or a fold of the path, which a smaller step does not pass.
const HALVINGS: u32 = 8;
/// The largest number of halvings of a Newton step. A step of 2⁻³⁰ cannot lower the energy by what its rounding shows.
const SHORTER: usize = 30;

/// Finds the equilibrium under a share of a load, from displacements that it changes; returns the residuals, and whether the forces balance.
type Settle<'a> = dyn FnMut(f64, &mut Vec<f64>) -> Result<(Vec<f64>, ForceBalance)> + 'a;

impl Newton {
    /// Applies the load from rest at `points`, `[points × dimension]`: `forces`, N, and the displacements that
    /// `support` prescribes grow together.
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn solve<'a>(
        &self,
        model: &dyn Elastic,
        points: &[f64],
        support: &Support,
        forces: impl Into<Applied<'a>>,
    ) -> Result<Equilibrium> {
        self.solve_with(model, points, support, forces.into(), None)
    }

    /// Applies the load as [`Newton::solve`] does, with the [pattern](Newton::pattern) of the tangents, if it is known.
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn solve_with(
        &self,
        model: &dyn Elastic,
        points: &[f64],
        support: &Support,
        forces: Applied,
        pattern: Option<&System>,
    ) -> Result<Equilibrium> {
        let mut statics = Statics::new(*self, Rest { model, points, support }, forces, pattern);
        let mut found = self.stepped(points.len(), &mut |load, u| statics.settle(load, u))?;
        found.shifted = statics.shifted;
        Ok(found)
    }

    /// Applies a load in steps; `settle` finds the equilibrium under a share of it from displacements nearby, of `dofs` degrees of freedom.
    pub(super) fn stepped(&self, dofs: usize, settle: &mut Settle) -> Result<Equilibrium> {
        let mut found = Equilibrium {
            ending: Ending::Converged,
            displacement: vec![0.0; dofs],
            path: Vec::new(),
            load: 0.0,
            residuals: Vec::new(),
            shifted: 0,
            is_rounded: false,
            pressures: Vec::new(),
        };
        let first = 1.0 / self.steps.max(1) as f64;
        let mut step = first;
        while found.load < 1.0 {
            // Sums of steps such as 1/3 end a rounding below one, and a step over that rounding would be one of no
            // load.
            let target = if found.load + step > 1.0 - 1e-12 { 1.0 } else { found.load + step };
            // A step that fails leaves displacements far from an equilibrium; the next one begins at the last that was
            // found.
            let mut u = found.displacement.clone();
            let (history, balance) = settle(target, &mut u)?;
            match balance {
                ForceBalance::Exact | ForceBalance::Rounded => {
                    found.residuals.push(history);
                    found.path.push(u.clone());
                    (found.displacement, found.load) = (u, target);
                    found.is_rounded = balance == ForceBalance::Rounded;
                    // What stopped a longer step may lie behind.
                    // No step is longer than those that were asked for.
                    step = (2.0 * step).min(first);
                }
                ForceBalance::None => {
                    step /= 2.0;
                    // So short a step does not pass a limit point or a fold either.
                    if step < first * 0.5f64.powi(HALVINGS as i32) {
                        found.residuals.push(history);
                        found.ending = Ending::Stalled;
                        break;
                    }
                }
            }
        }
        Ok(found)
    }

    /// The equilibrium under the whole load near the displacements `guess`; `None` if none is found from there.
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn settle(
        &self,
        model: &dyn Elastic,
        points: &[f64],
        support: &Support,
        forces: &[f64],
        guess: &[f64],
        pattern: Option<&System>,
    ) -> Result<Option<Vec<f64>>> {
        let mut statics = Statics::new(*self, Rest { model, points, support }, forces.into(), pattern);
        let mut u = guess.to_vec();
        let (_, balance) = statics.settle(1.0, &mut u)?;
        Ok((balance != ForceBalance::None).then_some(u))
    }

    /// Equations whose pattern all steps of a model share that has this tangent; it is analysed when it is first needed, once for all of
    /// its copies.
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn pattern(tangent: &Entries, support: &Support) -> Result<System> {
        System::new(&raised(tangent, support.prescribed.len(), 0.0), support)
    }

    /// The [pattern](Newton::pattern) of a model with this tangent at rest under these forces.
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn pattern_under(tangent: &Entries, support: &Support, points: &[f64], forces: Applied) -> Result<System> {
        let following = forces.stiffness(points, &vec![0.0; points.len()], 1.0);
        Newton::pattern(&with(tangent, &following), support)
    }

    /// The equations of a tangent in a known [pattern](Newton::pattern).
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn equations(pattern: &System, tangent: &Entries, support: &Support) -> Result<System> {
        pattern.renewed(&raised(tangent, support.prescribed.len(), 0.0), support)
    }
}

/// A tangent with that of forces that follow.
pub(super) fn with<'a>(tangent: &'a Entries, following: &Following) -> Cow<'a, Entries> {
    match following.is_empty() {
        true => Cow::Borrowed(tangent),
        false => Cow::Owned(tangent.iter().copied().chain(following.symmetric()).collect()),
    }
}

/// A tangent with `shift` on its diagonal, in entries after its own.
pub(super) fn raised(tangent: &Entries, size: usize, shift: f64) -> Entries {
    let mut raised = tangent.clone();
    // A shift of zero has its entries too, so that shifted tangents share the pattern and its analysis.
    raised.extend((0..size).map(|i| Triplet::new(i, i, shift)));
    raised
}

/// Whether the forces are in equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ForceBalance {
    /// To the tolerance.
    Exact,
    /// To their rounding error.
    Rounded,
    None,
}

/// A model with supports and loads.
struct Statics<'a> {
    newton: Newton,
    rest: Rest<'a>,
    /// The internal forces at rest, N: springs that pull against each other are not a load.
    tension: Vec<f64>,
    forces: Applied<'a>,
    /// The equations of the last tangent; all tangents have the same pattern.
    known: Option<System>,
    /// The number of iterations whose tangent was shifted.
    shifted: usize,
}

impl<'a> Statics<'a> {
    fn new(newton: Newton, rest: Rest<'a>, forces: Applied<'a>, pattern: Option<&System>) -> Statics<'a> {
        let mut tension = vec![0.0; forces.forces.len()];
        if !rest.model.forces(rest.points, &mut tension) {
            // A model without a response at rest fails in its first step, and tells it there.
            tension.fill(0.0);
        }
        Statics { newton, rest, tension, forces, known: pattern.cloned(), shifted: 0 }
    }

    /// Newton's method at one load; returns the residuals, and whether the forces are in equilibrium. If the rounding
    /// of the forces hides the residual, they are computed from the displacements.
    fn settle(&mut self, load: f64, u: &mut Vec<f64>) -> Result<(Vec<f64>, ForceBalance)> {
        let Statics { newton, rest: model, tension, forces, known, shifted } = self;
        let support = model.support;
        let (mut history, mut form) = (Vec::new(), Form::Position);
        let Some(mut now) = model.at(u, form) else { return Ok((history, ForceBalance::None)) };
        // Forces at rest within their rounding error are none, and do not act where the load is smaller.
        if norm(tension) <= now.rounding {
            tension.fill(0.0);
        }
        for _ in 0..newton.iterations {
            // The remaining part of the prescribed displacements.
            let moves: Vec<Option<f64>> =
                support.prescribed.iter().zip(&*u).map(|(p, u)| p.map(|p| load * p - u)).collect();
            let held = support.prescribed.iter().zip(&*u).filter_map(|(p, u)| p.map(|p| (load * p).abs().max(u.abs())));
            // Relative to the farthest of all, since what is prescribed as zero has no size of its own.
            let farthest = held.fold(0.0, f64::max);
            let moved = moves.iter().flatten().all(|m| m.abs() <= REACHED * farthest);
            let applied = forces.at(model.points, u);
            let of = |applied: &[f64], force: &[f64]| -> Vec<f64> {
                applied.iter().zip(force).map(|(f, g)| load * f - g).collect()
            };
            let left = |force: &[f64]| of(&applied, force);
            let acting = |force: &[f64]| {
                let own: Vec<f64> = force.iter().zip(&*tension).map(|(g, t)| g - t).collect();
                // The reactions of supports are among the forces that act: a body that is moved by its supports has no
                // other load.
                norm(&own).max(load * norm(&applied))
            };
            let mut rest = left(&now.force);
            let is_hidden = |now: &Internal, rest: &[f64]| moved && model.free(rest) <= now.rounding;
            let is_balanced =
                |now: &Internal, rest: &[f64]| moved && model.free(rest) <= newton.tolerance * acting(&now.force);
            if form == Form::Position && is_hidden(&now, &rest) && !is_balanced(&now, &rest) {
                form = Form::Displacement;
                let Some(finer) = model.at(u, form) else { return Ok((history, ForceBalance::None)) };
                now = finer;
                rest = left(&now.force);
            }
            let (size, acting) = (model.free(&rest), acting(&now.force));
            history.push(if acting > 0.0 { size / acting } else { 0.0 });
            if is_balanced(&now, &rest) {
                return Ok((history, ForceBalance::Exact));
            }
            let hidden = is_hidden(&now, &rest);
            // A body without a load that is moved as a whole has no forces: all that is left of them is their rounding.
            let is_unloaded = norm(&applied) == 0.0 && norm(tension) == 0.0;
            let has_no_forces = is_unloaded && form == Form::Displacement && acting <= RIGID * now.rounding;
            if hidden && has_no_forces {
                return Ok((history, ForceBalance::Rounded));
            }
            let rounded =
                if hidden && now.rounding <= ROUGHEST * acting { ForceBalance::Rounded } else { ForceBalance::None };
            let following = forces.stiffness(model.points, u, load);
            let Some((step, shift)) = direction(&now.response.tangent, &following, moves, &rest, known)? else {
                return Ok((history, rounded));
            };
            *shifted += usize::from(shift);
            // The energy minus the work of the load; it has no meaning while supports move.
            let potential = |r: &Internal, to: &[f64]| r.response.energy - load * forces.work(model.points, u, to);
            let (before, slope) = (potential(&now, u), -dot(&masked(&rest, support), &step));
            let mut length = 1.0;
            // If rounding hides the energy, only the full step can improve the result.
            let accepted = (0..if hidden { 1 } else { SHORTER }).find_map(|_| {
                let tried: Vec<f64> = u.iter().zip(&step).map(|(u, s)| u + length * s).collect();
                let internal = model.at(&tried, form);
                let good = internal.as_ref().is_some_and(|r| {
                    let falls = !hidden && falls_enough(before, potential(r, &tried), length * slope);
                    // Near the solution the rounding of the energy hides its decrease.
                    !moved || falls || model.free(&of(&forces.at(model.points, &tried), &r.force)) < 0.5 * size
                });
                length /= 2.0;
                internal.filter(|_| good).map(|r| (tried, r))
            });
            (*u, now) = match accepted {
                Some(better) => better,
                // The rounding error of a model may exceed its bound.
                None if form == Form::Position => {
                    form = Form::Displacement;
                    let Some(finer) = model.at(u, form) else { return Ok((history, rounded)) };
                    (u.clone(), finer)
                }
                None => return Ok((history, rounded)),
            };
        }
        Ok((history, ForceBalance::None))
    }
}

/// The Newton step, with the tangent shifted until it is positive definite; `None` if the shift would exceed the
/// tangent.
///
/// Forces that follow may have a part of their tangent that is not symmetric, where faces end at free points, see [`Following::corrected`].
fn direction(
    tangent: &Entries,
    following: &Following,
    moves: Vec<Option<f64>>,
    rest: &[f64],
    known: &mut Option<System>,
) -> Result<Option<(Vec<f64>, bool)>> {
    let support = Support { prescribed: moves };
    let tangent = &*with(tangent, following);
    // The largest entry before springs and cells are added is enough as a scale of shifts, and needs no sums.
    let diagonal = tangent.iter().filter(|e| e.row == e.col).map(|e| e.val.abs()).fold(0.0, f64::max);
    for shift in std::iter::once(0.0).chain(shifts()) {
        let shifted = raised(tangent, rest.len(), shift * diagonal);
        let system = match known.take() {
            Some(known) => known.renewed(&shifted, &support)?,
            None => System::new(&shifted, &support)?,
        };
        let system = known.insert(system);
        if let Some(factor) = system.cholesky()? {
            let (step, _) = system.solve(&factor, rest);
            let step = if following.is_empty() { step } else { following.corrected(system, &factor, step) };
            return Ok(step.iter().all(|s| s.is_finite()).then_some((step, shift > 0.0)));
        }
    }
    Ok(None)
}
