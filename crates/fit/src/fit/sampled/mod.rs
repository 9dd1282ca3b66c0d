//! Spring constants from the nodal forces of a hyperelastic element at many deformed shapes.
//!
//! A spring that measures c pulls with `T(c; p) ∇c`. The fit is
//! `min_p Σ_q w_q ‖f(x_q) − Σ_s T_s(c_s(x_q); p_s) ∇c_s(x_q)‖²`. If T is linear in its parameters, such as
//! `k (c − c₀)`, this is linear least squares. The equations are summed shape by shape, whatever their number. Only
//! nonlinear laws keep the shapes, as far as memory allows, and only norms other than the Euclidean one keep the
//! equations.
//!
//! Theory: page *Sampled fits* of the book.

mod block;
mod cell;
mod errors;
mod family;
mod inner;
mod newton;
mod numbers;
mod objective;
mod outcome;
mod placed;
mod quasi_newton;
mod sampling;
mod sets;
mod settings;
mod shapes;
mod starts;

pub use errors::{FamilyErrors, ShapeError};
pub use family::DeformationFamily;
pub use numbers::Design;
pub use objective::{ResidualFunction, ResidualObjective};
pub use outcome::{CellStart, SampledFits};
pub use sampling::{Part, Sampling, Source};
pub use settings::{SampledFit, Weights};
pub use starts::StartEnd;

use super::congruence::Congruence;
use super::constrained::solve_nonnegative;
use super::input::check_cells;
use super::normal::Rank;
use super::regression::{Norm, solve_norm};
use super::visit::each_cell;
use crate::bound::{self, check_count};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::material::State;
use crate::springs::{Force, Law, Springs};
use crate::stiffness::Hyperelastic;
use cell::{REST_RANGE, Sample, SampledCell};
use objective::Residuals;
use outcome::CellFit;
use quasi_newton::Quadratic;
use rayon::prelude::*;
use shapes::Drawing;
use std::sync::Arc;

/// The number of consecutive cells that one thread fits.
// A cell takes a tenth of a millisecond or more, beside which a thread begins for nothing; longer chunks would leave threads
// without work at the end of a round.
const CHUNK: usize = 8;
/// The largest number of values that a norm other than the Euclidean one may store for a cell: half a gigabyte.
const MOST_NUMBERS: usize = 1 << 26;

/// Fits every cell. `connectivity` is `[cells × nodes]` into `points`, `[points × dimension]`, m.
///
/// The energy may be a function ([`EnergyFunction`](crate::stiffness::EnergyFunction)) and so may laws of force
/// ([`Law::of_function`]); they are called on the threads of the fit. `progress` is called from time to time with the number
/// of finished cells.
///
/// # Errors
/// An array has a wrong length; a function has failed; a coordinate is not finite; the springs belong to another element; the state is not one
/// of its dimension; a cell is tangled; the numbers of the sampling are out of range; or the cells are those of a
/// surface or curve in space.
#[allow(clippy::too_many_arguments)]
pub fn fit_sampled(
    element: &Arc<Element>,
    springs: &Springs,
    points: &[f64],
    connectivity: &[usize],
    energy: &dyn Hyperelastic,
    state: State,
    fit: &SampledFit,
    progress: &mut dyn FnMut(usize),
) -> Result<SampledFits> {
    // A sum without springs has no unknown to fit.
    if springs.is_empty() {
        return Err(Error::expected("springs", "at least one spring to fit", "none"));
    }
    springs.check(element)?;
    element.check_plain("sampled fits, which are those of large deformation")?;
    fit.check(element.dimension())?;
    if element.space() > element.dimension() {
        let problem = "the sampled fit is known for cells that fill their space";
        return Err(Error::new(problem).of_kind(ErrorKind::Unsupported));
    }
    fit.force.check(springs.names().len())?;
    fit.each_set(|sampling| sampling.check_states(points.len()))?;
    check_cells(element, points, connectivity)?;
    state.check(element.dimension())?;
    let n = element.nodes();
    let cells = connectivity.len() / n;
    // By translation alone: shapes are drawn along axes in space, which do not turn with a cell.
    let Congruence { representatives, shapes } = Congruence::by_translation(element, points, connectivity)?;
    let mut alike: Vec<Vec<&[usize]>> = vec![Vec::new(); representatives.len()];
    connectivity.chunks_exact(n).zip(&shapes).for_each(|(nodes, &shape)| alike[shape].push(nodes));
    let chunk = |chunk: &[(usize, Vec<&[usize]>)]| {
        let mut found = Vec::new();
        for (cell, alike) in chunk {
            let nodes = &connectivity[cell * n..(cell + 1) * n];
            let mut outcome = Ok(());
            each_cell(element, points, nodes, *cell, |_, x, geometry| {
                let drawing = Drawing {
                    rest: x,
                    cells: alike,
                    points,
                    dimension: element.dimension(),
                    extent: geometry.content().powf(1.0 / element.dimension() as f64),
                    poisson: energy.poisson(),
                };
                let mut found_by = SampledCell::new(element, springs, geometry, energy, state, fit, drawing);
                match found_by.fit(*cell) {
                    Ok(one) => found.push(one),
                    Err(error) => outcome = Err(error),
                }
            })?;
            outcome?;
        }
        Ok(found)
    };
    let mut fitted: Vec<CellFit> = Vec::new();
    let chosen: Vec<(usize, Vec<&[usize]>)> = representatives.into_iter().zip(alike).collect();
    for round in chosen.chunks(CHUNK * 4 * rayon::current_num_threads()) {
        let parts: Vec<Result<Vec<CellFit>>> = round.par_chunks(CHUNK).map(chunk).collect();
        // Parts are in the order of the cells, so that the first faulty cell is told and the lists do not depend on threads.
        for part in parts {
            fitted.extend(part?);
        }
        progress(fitted.len() * cells / chosen.len());
    }
    let mut all = SampledFits::new(springs, fit);
    all.fits.reused = cells - fitted.len();
    fitted.iter().try_for_each(|one| all.count(one))?;
    shapes.iter().for_each(|&shape| all.add(&fitted[shape]));
    Ok(all)
}

impl SampledFit {
    /// The number of unknowns of a spring of the group.
    fn columns(&self, group: usize) -> usize {
        match &self.force {
            Force::Linear => 1,
            Force::FreeRest | Force::Exact { .. } => REST_RANGE.len(),
            Force::Laws(laws) => laws[group].parameters.len(),
        }
    }

    fn check(&self, dimension: usize) -> Result<()> {
        if !(0.0..=1.0).contains(&self.higher) {
            return Err(Error::expected("higher", "a scale from 0 to 1", self.higher));
        }
        check_count("starts", self.starts as u64, 1, bound::STARTS)?;
        if let Force::Exact { .. } = self.force {
            return Err(Error::at("force", "is that of exact networks, which are not fitted to samples"));
        }
        if let Norm::Huber { share } = self.norm
            && !(share > 0.0 && share.is_finite())
        {
            return Err(Error::expected("huber", "a share above 0 of the size of the forces", share));
        }
        for (name, [lower, upper]) in &self.bounds {
            let laws: &[Arc<Law>] = if let Force::Laws(laws) = &self.force { laws } else { &[] };
            let mut known: Vec<&str> = laws.iter().flat_map(|law| &law.parameters).map(String::as_str).collect();
            known.dedup();
            if !known.contains(&name.as_str()) {
                let expected = match laws {
                    [] => "no bounds without a law of force".to_string(),
                    _ => format!("parameters of the law, {}", known.join(", ")),
                };
                return Err(Error::expected("bounds", expected, format!("\"{name}\"")));
            }
            let lowest = if self.nonnegative { 0.0 } else { f64::NEG_INFINITY };
            if !(lower <= upper && *upper >= lowest && *lower < f64::INFINITY && *upper > f64::NEG_INFINITY) {
                let expected = match self.nonnegative {
                    true => "a lower and an upper bound that is not below zero",
                    false => "a lower and an upper bound",
                };
                let found = format!("{lower} to {upper}");
                return Err(Error::expected(format!("bounds.{name}"), expected, found));
            }
        }
        if (self.norm != Norm::Two || self.objective.is_some()) && (!self.is_direct() || !self.bounds.is_empty()) {
            let expected = "the 2-norm for a law with bounds or that is not linear in its parameters";
            let function = self.objective.as_ref().map(|objective| format!("the function \"{}\"", objective.name()));
            return Err(Error::expected("norm", expected, function.unwrap_or_else(|| format!("{:?}", self.norm))));
        }
        self.each_set(|sampling| sampling.check(dimension))?;
        if self.data && self.sets().all(|sampling| sampling.held_out == 0 && sampling.others.is_none()) {
            return Err(Error::expected("held_out", "shapes whose errors are the data", "none"));
        }
        Ok(())
    }

    /// Checks each set; the key of an error begins with the number of the set if there are several.
    fn each_set(&self, check: impl Fn(&Sampling) -> Result<()>) -> Result<()> {
        let several = !self.beside.is_empty();
        let named = |(i, error): (usize, Error)| if several { error.under(format!("[{i}]")) } else { error };
        let check = |(i, sampling)| check(sampling).map_err(|error| named((i, error)));
        self.sets().enumerate().try_for_each(check)
    }

    /// Whether the forces are linear in the unknowns.
    fn is_direct(&self) -> bool {
        !matches!(&self.force, Force::Laws(laws) if laws.iter().any(|law| !law.is_linear()))
    }
}

impl SampledCell<'_> {
    fn fit(&mut self, cell: usize) -> Result<CellFit> {
        let (unknowns, found) = match &self.fit.force {
            Force::Laws(_) if !self.fit.is_direct() || !self.fit.bounds.is_empty() => self.iterated()?,
            // Functions are asked for many shapes at once there.
            Force::Laws(_) if self.has_functions() && self.is_squared() => self.iterated()?,
            _ => self.direct()?,
        };
        // A law that was taken for linear at a few values must be so at the optimum, where its derivatives were used.
        for s in 0..self.len() {
            let own = self.of_spring(s, &unknowns);
            self.law(s).map_or(Ok(()), |law| law.check_linear(self.rest(s), own))?;
        }
        let held_out = self.evaluate(Part::HeldOut, &unknowns, self.fit.data)?;
        let mut errors = match self.fit.data {
            true => self.evaluate(Part::Trained, &unknowns, true)?.shapes,
            false => Vec::new(),
        };
        let (constants, parameters) = self.written(&unknowns);
        let finite = constants.iter().chain(&parameters).all(|k| k.is_finite());
        // The error is relative to the forces of the material.
        if finite && found.trained.is_nan() {
            let expected = "shapes that deform the element, so that the material has forces there";
            let found = "the shape at rest, or rotations of it, alone";
            return Err(Error::expected("shapes", expected, found).of_kind(ErrorKind::Infeasible));
        }
        if !(finite && found.trained.is_finite()) {
            let expected = "a law with finite values at the sampled shapes and a finite slope at rest";
            return Err(Error::expected("force", expected, "one without").of_kind(ErrorKind::Infeasible));
        }
        let (shapes, held) = (self.shapes(Part::Trained), held_out.error());
        errors.extend(held_out.shapes);
        errors.iter_mut().for_each(|error| error.cell = cell);
        let families = held_out.families;
        Ok(CellFit { constants, parameters, cell, shapes, held_out: held, families, errors, ..found })
    }

    /// Whether the sum of squares is minimised.
    fn is_squared(&self) -> bool {
        self.fit.norm == Norm::Two && self.fit.objective.is_none()
    }

    fn has_functions(&self) -> bool {
        matches!(&self.fit.force, Force::Laws(laws) if laws.iter().any(|law| law.is_function()))
    }

    fn direct(&self) -> Result<(Vec<f64>, CellFit)> {
        // The two unknowns are constants of springs at both ends of the range
        // of rest measures: none below zero keeps the rest measure in between.
        let bounded = self.fit.nonnegative || self.fit.force == Force::FreeRest;
        let sums = self.sums(Part::Trained, &vec![0.0; self.count()])?;
        let squares = || if bounded { solve_nonnegative(&sums.normal) } else { sums.normal.solve() };
        let (unknowns, rank, converged) = match &self.fit.objective {
            _ if self.is_squared() => {
                let (unknowns, rank) = squares();
                (unknowns, rank, true)
            }
            Some(objective) => {
                let (start, rank) = squares();
                let (rows, rhs) = self.all_equations()?;
                let shape = [self.shapes(Part::Trained), self.seen() / self.dimension(), self.dimension()];
                let residuals = Residuals { rows: &rows, rhs: &rhs, shape };
                let quadratic = Quadratic { gram: &sums.normal.gram, nonnegative: bounded };
                let found = objective.minimize(&residuals, &quadratic, start)?;
                (found.unknowns, rank, found.converged)
            }
            None => {
                let (rows, rhs) = self.all_equations()?;
                match solve_norm(&rows, &rhs, self.count(), self.fit.norm, bounded) {
                    Some(unknowns) => (unknowns, Rank::Full, true),
                    None => {
                        let (unknowns, rank) = squares();
                        (unknowns, rank, false)
                    }
                }
            }
        };
        let trained = sums.error(&unknowns);
        let converged = converged && rank != Rank::Unsolved;
        Ok((unknowns, CellFit { rank, converged, trained, reduced: sums.reduced, ..CellFit::default() }))
    }

    /// The equations of all shapes of the fit, for objectives that normal equations cannot express.
    fn all_equations(&self) -> Result<(Vec<f64>, Vec<f64>)> {
        let (shapes, count, seen) = (self.shapes(Part::Trained), self.count(), self.seen());
        // Counts of a user may overflow a product, which then is above any limit.
        if shapes.saturating_mul(seen).saturating_mul(count) > MOST_NUMBERS {
            let expected = format!("at most {} shapes in this norm", MOST_NUMBERS / (seen * count));
            return Err(Error::expected("shapes", expected, shapes).of_kind(ErrorKind::Limit));
        }
        let (mut rows, mut rhs) = (Vec::new(), Vec::new());
        let mut sample = Sample::default();
        for placed in self.placed(Part::Trained, &(0..shapes).collect::<Vec<_>>())? {
            self.sample(&placed, &mut sample)?;
            self.equations(&sample, &vec![0.0; count], &mut rows, &mut rhs);
        }
        Ok((rows, rhs))
    }

    fn iterated(&mut self) -> Result<(Vec<f64>, CellFit)> {
        let lowest = if self.fit.nonnegative { 0.0 } else { f64::NEG_INFINITY };
        let bounds = self.each_parameter(|law, i| {
            let given = self.fit.bounds.iter().find(|(bounded, _)| *bounded == law.parameters[i]);
            given.map_or([lowest, f64::INFINITY], |(_, [lower, upper])| [lower.max(lowest), *upper])
        });
        // Laws that are linear in their parameters have one optimum.
        let starts = if self.fit.is_direct() { 1 } else { self.fit.starts };
        let found = inner::search(self, starts, &bounds)?;
        let trained = found.sums.error(&vec![0.0; self.count()]);
        let agreeing = Some(found.agreeing);
        let (converged, starts, reduced) = (found.converged, found.starts, found.sums.reduced);
        let rest = CellFit { trained, converged, agreeing, starts, reduced, ..CellFit::default() };
        Ok((found.unknowns, rest))
    }

    /// The constants and parameters of all springs, in the order of [`CellFits`].
    fn written(&self, unknowns: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut constants, mut parameters) = (Vec::new(), Vec::new());
        for s in 0..self.len() {
            let (own, rest) = (self.of_spring(s, unknowns), self.rest(s));
            match &self.fit.force {
                Force::Linear => constants.push(own[0]),
                Force::FreeRest | Force::Exact { .. } => {
                    constants.push(own.iter().sum());
                    parameters.push(own.iter().zip(REST_RANGE).map(|(k, share)| k * share * rest).sum());
                }
                Force::Laws(_) => {
                    constants.push(self.law(s).map_or(0.0, |law| law.slope(rest, rest, own)));
                    parameters.extend(own);
                }
            }
        }
        (constants, parameters)
    }
}
