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
mod inner;
mod newton;
mod placed;
mod settings;
mod shapes;

pub use settings::{SampledFit, Weights};
pub use shapes::{DeformationFamily, Sampling, Source};

use super::cells::CellFits;
use super::congruence::Congruence;
use super::constrained::solve_nonnegative;
use super::input::check_cells;
use super::normal::Rank;
use super::norms::{Norm, solve_norm};
use super::visit::each_cell;
use crate::bound::{self, check_count};
use crate::element::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::material::State;
use crate::springs::{Force, Law, Springs};
use crate::stiffness::Hyperelastic;
use block::Drawn;
use cell::{REST_RANGE, Sample, SampledCell};
use rayon::prelude::*;
use shapes::{Part, Shapes};
use std::sync::Arc;

/// The number of consecutive cells that one thread fits.
const CHUNK: usize = 8;
/// The largest number of values that a norm other than the Euclidean one may store for a cell: half a gigabyte.
const MOST_NUMBERS: usize = 1 << 26;

/// The constants of all cells, and the errors at the shapes.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SampledFits {
    /// The constants and parameters.
    pub fits: CellFits,
    /// The number of shapes of the fit, that of the cell with the most.
    pub shapes: usize,
    /// `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` on the shapes of the fit, `[cells]`, with f the forces of the element and K those of
    /// its springs.
    pub trained: Vec<f64>,
    /// The error `√(Σ w ‖f − K‖²/Σ w ‖f‖²)` of the springs' forces K from those of the element, f, on the shapes that were held out,
    /// `[cells]`; NaN if there are none.
    pub held_out: Vec<f64>,
    /// For laws that are not linear in their parameters: the share of the starts that ended at the best error, the
    /// least over the cells.
    pub agreeing: Option<f64>,
}

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
    if springs.is_empty() {
        return Err(Error::expected("springs", "at least one spring to fit", "none"));
    }
    springs.check(element)?;
    fit.check(element.dimension())?;
    if element.space() > element.dimension() {
        let problem = "the sampled fit is known for cells that fill their space";
        return Err(Error::new(problem).of_kind(ErrorKind::Unsupported));
    }
    fit.force.check(springs.names.len())?;
    fit.sampling.check_states(points.len())?;
    check_cells(element, points, connectivity)?;
    state.check(element.dimension())?;
    let n = element.nodes();
    let cells = connectivity.len() / n;
    let Congruence { representatives, shapes } = Congruence::by_translation(element, points, connectivity)?;
    let mut alike: Vec<Vec<&[usize]>> = vec![Vec::new(); representatives.len()];
    connectivity.chunks_exact(n).zip(&shapes).for_each(|(nodes, &shape)| alike[shape].push(nodes));
    let chunk = |chunk: &[(usize, Vec<&[usize]>)]| {
        let mut found = Vec::new();
        for (cell, alike) in chunk {
            let nodes = &connectivity[cell * n..(cell + 1) * n];
            let mut outcome = Ok(());
            each_cell(element, points, nodes, *cell, |_, x, geometry| {
                let shapes = Shapes {
                    sampling: &fit.sampling,
                    rest: x,
                    cells: alike.clone(),
                    points,
                    dimension: element.dimension(),
                    extent: geometry.content().powf(1.0 / element.dimension() as f64),
                    poisson: energy.poisson(),
                };
                let mut cell = SampledCell::new(element, springs, geometry, energy, state, fit, shapes);
                match cell.fit() {
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
        for part in parts {
            fitted.extend(part?);
        }
        progress(fitted.len() * cells / chosen.len());
    }
    let mut all = SampledFits {
        fits: CellFits::new(springs.clone()),
        shapes: fitted.iter().map(|f| f.shapes).max().unwrap_or(0),
        trained: Vec::new(),
        held_out: Vec::new(),
        agreeing: fitted.iter().filter_map(|f| f.agreeing).reduce(f64::min),
    };
    all.fits.unreached = fitted.iter().filter(|f| !f.converged).count();
    all.fits.force = fit.force.clone();
    all.fits.deficient = fitted.iter().filter(|f| f.rank == Rank::Deficient).count();
    all.fits.reused = cells - fitted.len();
    for one in shapes.iter().map(|&shape| &fitted[shape]) {
        all.fits.constants.extend(&one.constants);
        all.fits.parameters.extend(&one.parameters);
        all.trained.push(one.trained);
        all.held_out.push(one.held_out);
    }
    Ok(all)
}

/// The outcome of one cell.
#[derive(Default)]
struct CellFit {
    constants: Vec<f64>,
    parameters: Vec<f64>,
    rank: Rank,
    converged: bool,
    agreeing: Option<f64>,
    shapes: usize,
    trained: f64,
    held_out: f64,
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
        if self.norm != Norm::Two && (!self.is_direct() || !self.bounds.is_empty()) {
            let expected = "the 2-norm for a law with bounds or that is not linear in its parameters";
            return Err(Error::expected("norm", expected, format!("{:?}", self.norm)));
        }
        self.sampling.check(dimension)
    }

    /// Whether the forces are linear in the unknowns.
    fn is_direct(&self) -> bool {
        !matches!(&self.force, Force::Laws(laws) if laws.iter().any(|law| !law.is_linear()))
    }
}

impl SampledCell<'_> {
    fn fit(&mut self) -> Result<CellFit> {
        let (unknowns, found) = match &self.fit.force {
            Force::Laws(_) if !self.fit.is_direct() || !self.fit.bounds.is_empty() => self.iterated()?,
            // Functions are asked for many shapes at once there.
            Force::Laws(_) if self.has_functions() && self.fit.norm == Norm::Two => self.iterated()?,
            _ => self.direct()?,
        };
        for s in 0..self.len() {
            let own = self.of_spring(s, &unknowns);
            self.law(s).map_or(Ok(()), |law| law.check_linear(self.rest(s), own))?;
        }
        let held_out = match (self.has_others(), self.has_functions()) {
            (false, _) => f64::NAN,
            (true, false) => self.sums(Part::HeldOut, &unknowns)?.error(&vec![0.0; self.count()]),
            (true, true) => {
                let shapes = Drawn::new(self, Part::HeldOut, (0..self.shapes(Part::HeldOut)).collect())?;
                shapes.sums(&unknowns, &vec![false; self.count()])?.sums.error(&vec![0.0; self.count()])
            }
        };
        let (constants, parameters) = self.written(&unknowns);
        let finite = constants.iter().chain(&parameters).all(|k| k.is_finite());
        if !(finite && found.trained.is_finite()) {
            let expected = "a law with finite values at the sampled shapes and a finite slope at rest";
            return Err(Error::expected("force", expected, "one without").of_kind(ErrorKind::Infeasible));
        }
        Ok(CellFit { constants, parameters, shapes: self.shapes(Part::Trained), held_out, ..found })
    }

    fn has_functions(&self) -> bool {
        matches!(&self.fit.force, Force::Laws(laws) if laws.iter().any(|law| law.is_function()))
    }

    fn direct(&self) -> Result<(Vec<f64>, CellFit)> {
        let bounded = self.fit.nonnegative || self.fit.force == Force::FreeRest;
        let in_norm = if self.fit.norm == Norm::Two { None } else { self.in_norm(bounded)? };
        let in_its_norm = self.fit.norm == Norm::Two || in_norm.is_some();
        let sums = self.sums(Part::Trained, &vec![0.0; self.count()])?;
        let (unknowns, rank) = match in_norm {
            Some(unknowns) => (unknowns, Rank::Full),
            None if bounded => solve_nonnegative(&sums.normal),
            None => sums.normal.solve(),
        };
        let trained = sums.error(&unknowns);
        let converged = in_its_norm && rank != Rank::Unsolved;
        Ok((unknowns, CellFit { rank, converged, trained, ..CellFit::default() }))
    }

    /// The unknowns with the least residual forces in a norm that normal equations cannot express. All shapes are
    /// stored.
    fn in_norm(&self, bounded: bool) -> Result<Option<Vec<f64>>> {
        let (shapes, count, seen) = (self.shapes(Part::Trained), self.count(), self.seen());
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
        Ok(solve_norm(&rows, &rhs, count, self.fit.norm, bounded))
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
        let rest = CellFit { trained, converged: found.converged, agreeing, ..CellFit::default() };
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
