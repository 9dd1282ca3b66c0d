//! Statics at large deformation: Newton's method with load steps and a line search, on the finite elements or on a network.

use super::linear::System;
use crate::error::Result;
use crate::model::{Elastic, Entries, Response, Support, displaced};
use crate::springs::{dot, norm};
use faer::sparse::Triplet;

/// How the load is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newton {
    /// Steps in which the load is applied at first; one that fails is halved.
    pub steps: usize,
    /// Iterations in one step.
    pub iterations: usize,
    /// Largest residual, relative to the forces that act.
    pub tolerance: f64,
}

impl Default for Newton {
    fn default() -> Newton {
        Newton { steps: 1, iterations: 40, tolerance: 1e-10 }
    }
}

/// How far a solution came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    Converged,
    /// No shorter step of the load came to an equilibrium either.
    Stalled,
}

/// An equilibrium, or the last one found.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    pub ending: Ending,
    /// `[points · dimension]`, m.
    pub displacement: Vec<f64>,
    /// The displacements at the loads on the way, the last one being `displacement` if any load was reached.
    pub path: Vec<Vec<f64>>,
    /// The share of the load that it carries, 1 if converged.
    pub load: f64,
    /// Residuals of the iterations of each step, relative to the forces that act.
    pub residuals: Vec<Vec<f64>>,
    /// Iterations whose tangent was not positive definite and had to be shifted.
    pub shifted: usize,
}

/// A step of the load is not halved more often.
const HALVINGS: u32 = 8;
/// Nor is a Newton step.
const SHORTER: usize = 30;
/// Share of the slope by which the energy must fall along a step (Armijo 1966).
const DESCENT: f64 = 1e-4;

impl Newton {
    /// Follows the load from rest at `points`, `[points × dimension]`: `forces`, N, and the displacements that `support`
    /// prescribes grow together.
    ///
    /// # Errors
    /// The tangent does not fit into memory.
    pub fn solve(&self, model: &dyn Elastic, points: &[f64], support: &Support, forces: &[f64]) -> Result<Equilibrium> {
        let mut statics = Statics { newton: *self, model, points, support, forces, known: None, shifted: 0 };
        let mut found = Equilibrium {
            ending: Ending::Converged,
            displacement: vec![0.0; points.len()],
            path: Vec::new(),
            load: 0.0,
            residuals: Vec::new(),
            shifted: 0,
        };
        let first = 1.0 / self.steps.max(1) as f64;
        let mut step = first;
        while found.load < 1.0 {
            let target = if found.load + step > 1.0 - 1e-12 { 1.0 } else { found.load + step };
            let mut u = found.displacement.clone();
            match statics.settle(target, &mut u)? {
                (history, true) => {
                    found.residuals.push(history);
                    found.path.push(u.clone());
                    (found.displacement, found.load) = (u, target);
                    step = (2.0 * step).min(first);
                }
                (history, false) => {
                    step /= 2.0;
                    if step < first * 0.5f64.powi(HALVINGS as i32) {
                        found.residuals.push(history);
                        found.ending = Ending::Stalled;
                        break;
                    }
                }
            }
        }
        found.shifted = statics.shifted;
        Ok(found)
    }

    /// The equilibrium under the whole load next to the displacements `guess`; `None` where none is found from there.
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
    ) -> Result<Option<Vec<f64>>> {
        let mut statics = Statics { newton: *self, model, points, support, forces, known: None, shifted: 0 };
        let mut u = guess.to_vec();
        let (_, converged) = statics.settle(1.0, &mut u)?;
        Ok(converged.then_some(u))
    }
}

/// A model that is held and loaded.
struct Statics<'a> {
    newton: Newton,
    model: &'a dyn Elastic,
    points: &'a [f64],
    support: &'a Support,
    forces: &'a [f64],
    /// The equations of the last tangent: all have the same pattern.
    known: Option<System>,
    /// Iterations whose tangent had to be shifted.
    shifted: usize,
}

impl Statics<'_> {
    /// Newton's method at one load; the residuals, and whether they came below the tolerance.
    fn settle(&mut self, load: f64, u: &mut Vec<f64>) -> Result<(Vec<f64>, bool)> {
        let Statics { newton, model, points, support, forces, known, shifted } = self;
        let mut history = Vec::new();
        let Some(mut now) = model.respond(&displaced(points, u)) else { return Ok((history, false)) };
        for _ in 0..newton.iterations {
            // What is still to be moved of the prescribed displacements.
            let moves: Vec<Option<f64>> =
                support.prescribed.iter().zip(&*u).map(|(p, u)| p.map(|p| load * p - u)).collect();
            let moved = moves.iter().flatten().all(|m| m.abs() <= 1e-14 * (1.0 + norm(u)));
            let rest: Vec<f64> = forces.iter().zip(&now.force).map(|(f, g)| load * f - g).collect();
            let free = |v: &[f64]| norm(&masked(v, support));
            let acting = norm(&now.force).max(load * norm(forces));
            let residual = if acting > 0.0 { free(&rest) / acting } else { 0.0 };
            history.push(residual);
            if moved && residual <= newton.tolerance {
                return Ok((history, true));
            }
            let Some((step, shift)) = direction(&now.tangent, moves, &rest, known)? else {
                return Ok((history, false));
            };
            *shifted += usize::from(shift);
            // Of the energy less the work of the load; while supports move it says nothing.
            let potential = |r: &Response, u: &[f64]| r.energy - load * dot(forces, u);
            let (before, slope) = (potential(&now, u), -dot(&masked(&rest, support), &step));
            let mut length = 1.0;
            let accepted = (0..SHORTER).find_map(|_| {
                let tried: Vec<f64> = u.iter().zip(&step).map(|(u, s)| u + length * s).collect();
                let response = model.respond(&displaced(points, &tried));
                let good = response.as_ref().is_some_and(|r| {
                    let after: Vec<f64> = forces.iter().zip(&r.force).map(|(f, g)| load * f - g).collect();
                    let falls = potential(r, &tried) <= before + DESCENT * length * slope;
                    // Next to the end the energy's rounding hides its fall.
                    !moved || falls || free(&after) < 0.5 * free(&rest)
                });
                length /= 2.0;
                response.filter(|_| good).map(|r| (tried, r))
            });
            let Some((tried, response)) = accepted else { return Ok((history, false)) };
            (*u, now) = (tried, response);
        }
        Ok((history, false))
    }
}

/// The Newton step, with the tangent shifted until it is positive definite; `None` if that takes more than its own size.
fn direction(
    tangent: &Entries,
    moves: Vec<Option<f64>>,
    rest: &[f64],
    known: &mut Option<System>,
) -> Result<Option<(Vec<f64>, bool)>> {
    let support = Support { prescribed: moves };
    let diagonal = tangent.iter().filter(|e| e.row == e.col).map(|e| e.val.abs()).fold(0.0, f64::max);
    let mut shift = 0.0;
    let mut shifted = tangent.clone();
    loop {
        shifted.truncate(tangent.len());
        shifted.extend((0..rest.len()).map(|i| Triplet::new(i, i, shift * diagonal)));
        let system = match known.take() {
            Some(known) => known.renewed(&shifted, &support)?,
            None => System::new(&shifted, &support)?,
        };
        let system = known.insert(system);
        if let Some(factor) = system.cholesky()? {
            let (step, _) = system.solve(&factor, rest);
            return Ok(step.iter().all(|s| s.is_finite()).then_some((step, shift > 0.0)));
        }
        shift = if shift == 0.0 { 1e-4 } else { 10.0 * shift };
        if shift > 10.0 {
            return Ok(None);
        }
    }
}

/// The entries of the free degrees of freedom, zero elsewhere.
fn masked(v: &[f64], support: &Support) -> Vec<f64> {
    v.iter().enumerate().map(|(i, v)| if support.is_fixed(i) { 0.0 } else { *v }).collect()
}
