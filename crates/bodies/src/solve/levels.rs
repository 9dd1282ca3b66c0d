//! Linear statics by conjugate gradients with smoothed-aggregation multigrid: for equations too large to be factorised.

use super::inertia::Masses;
use super::method::StaticSolver;
use super::modes::{Modes, modes_of};
use super::stability::{Stability, Standing, standing};
use crate::error::{Error, ErrorKind, Result};
use crate::memory::available;
use crate::model::{BlockStiffness, Support};
use crate::number::or_nan;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use springfit_multigrid::{
    Definiteness, End, Event, Extreme, Fault, Multigrid, Settings, Solution, WIDTH, Watch, sizes,
};
use springfit_multigrid::{plane_motions, space_motions};
use std::ops::ControlFlow;

/// The chance of a wrong "positive definite" that is let pass. A wrong verdict is then less likely than a fault of the
/// machine.
const DOUBT: f64 = 1e-12;
/// Steps of the proof at most.
// Each step lowers Chebyshev's bound by `e^−acosh((1 + θ)/(1 − θ))`: where the least eigenvalue θ is 5e-5 of the
// largest, 3 000 steps lower it to 4e-19.
const STEPS: usize = 3000;
/// Steps to the least ratio of energies, and to the largest, at most.
// Networks of boxes take some 20 steps to the least ratio, and 14 or more to the largest. After 32 steps the largest is 0.5 % too small on a
// bar of tetrahedra with Poisson's ratio 0.45.
const END_STEPS: usize = 100;

/// Vectors of a solution with its levels, about.
// Side by side with seven others they are the 768 bytes per unknown of `docs/src/theory/multigrid.md`.
const VECTORS: usize = 12;

/// The solutions in the iteration for modes have this tolerance.
// An eigenpair is accepted at a residual of 1e-11 (`FOUND` of `modes.rs`), which solutions that err by as much would not reach.
const MODE_TOLERANCE: f64 = 1e-12;

/// Called with the share of a solution that is done.
pub type Share<'a> = dyn FnMut(f64) + 'a;

/// The equations of the free degrees of freedom with the levels that solve them.
#[derive(Debug)]
pub struct Levels {
    stiffness: BlockStiffness,
    hierarchy: Hierarchy,
    prescribed: Vec<Option<f64>>,
}

#[derive(Debug)]
enum Hierarchy {
    Plane(Multigrid<2, 3>),
    Space(Multigrid<3, 6>),
}

/// How linear equations were solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Solved {
    /// The equations were solved by `cholesky`, `ldl`, `lu` or `multigrid`.
    pub method: String,
    /// This number of displacements is not held.
    pub unknowns: usize,
    /// Conjugate gradients took this number of iterations; it is null with a factor.
    pub iterations: Option<usize>,
    /// The share `‖f − K u‖/‖f‖` of the forces is left.
    #[serde(deserialize_with = "or_nan")]
    #[schemars(with = "Option<f64>")]
    pub residual: f64,
    /// The text has nodes and unknowns of each on all levels of the multigrid, the finest first; it is null with a factor.
    pub levels: Option<String>,
}

/// `Ok` with the levels, or with the motion that shows that the stiffness is not positive definite, on all degrees of freedom.
pub type Built = Result<std::result::Result<Levels, Vec<f64>>>;

impl Levels {
    /// `points` are `[points × dimension]`, m.
    ///
    /// # Errors
    /// The points do not group: kind `Limit`.
    pub fn new(stiffness: BlockStiffness, points: &[f64], support: &Support) -> Built {
        let held: Vec<bool> = support.prescribed.iter().map(Option::is_some).collect();
        let settings = Settings::default();
        let watch: &mut Watch = &mut |_| ControlFlow::Continue(());
        let built = match &stiffness {
            BlockStiffness::Plane(matrix) => {
                Multigrid::new(matrix.clone(), &plane_motions(points, &held), &held, &settings, watch)
                    .map(Hierarchy::Plane)
            }
            BlockStiffness::Space(matrix) => {
                Multigrid::new(matrix.clone(), &space_motions(points, &held), &held, &settings, watch)
                    .map(Hierarchy::Space)
            }
        };
        match built {
            Ok(hierarchy) => Ok(Ok(Levels { stiffness, hierarchy, prescribed: support.prescribed.clone() })),
            Err(Fault::NotPositive(motion)) => Ok(Err(motion.displacement)),
            Err(fault) => Err(limit(&fault)),
        }
    }

    /// The stiffness of all degrees of freedom.
    pub fn stiffness(&self) -> &BlockStiffness {
        &self.stiffness
    }

    /// The number of degrees of freedom, free or held.
    pub fn degrees(&self) -> usize {
        self.prescribed.len()
    }

    /// The number of free degrees of freedom.
    pub fn size(&self) -> usize {
        self.prescribed.iter().filter(|u| u.is_none()).count()
    }

    /// The displacements of all degrees of freedom under the nodal forces f, `[points · dimension]`.
    ///
    /// # Errors
    /// The iterations stall: kind `Limit`, at the key `solver.iterations` if they were too few. The stiffness is not positive definite:
    /// kind `Infeasible`.
    pub fn solve(&self, f: &[f64], solver: &StaticSolver, share: &mut Share) -> Result<(Vec<f64>, Solved)> {
        Ok(self.solve_each(&[f], solver, share)?.remove(0))
    }

    /// Finds the displacements of all degrees of freedom under each of several nodal forces, `[points · dimension]`, side by side as far as
    /// memory allows.
    ///
    /// # Errors
    /// As [`Levels::solve`].
    pub fn solve_each(
        &self,
        forces: &[&[f64]],
        solver: &StaticSolver,
        share: &mut Share,
    ) -> Result<Vec<(Vec<f64>, Solved)>> {
        let (displacement, reaction) = self.held(&self.stiffness);
        let rest = |f: &&[f64]| f.iter().zip(&reaction).map(|(f, r)| f - r).collect::<Vec<f64>>();
        let found = self.found(&forces.iter().map(rest).collect::<Vec<_>>(), solver, share)?;
        let whole = |found: Solution| {
            let solved = self.told("multigrid", &found);
            let mut u = found.displacement;
            u.iter_mut().zip(&displacement).for_each(|(u, held)| *u += held);
            (u, solved)
        };
        Ok(found.into_iter().map(whole).collect())
    }

    /// The changes of the displacements for changes of each of several nodal forces.
    ///
    /// # Errors
    /// As [`Levels::solve`].
    pub fn respond_all(&self, forces: &[Vec<f64>], solver: &StaticSolver) -> Result<Vec<Vec<f64>>> {
        Ok(self.found(forces, solver, &mut |_| ())?.into_iter().map(|found| found.displacement).collect())
    }

    /// What is free, with all else zero.
    fn found(&self, forces: &[Vec<f64>], solver: &StaticSolver, share: &mut Share) -> Result<Vec<Solution>> {
        let bytes = (VECTORS * WIDTH * size_of::<f64>() * self.degrees()) as u64;
        // Loads side by side share each reading of the matrix, but have vectors of their own. Where these do not fit
        // one load at a time does.
        let fits = forces.len() <= 1 || available().is_none_or(|available| bytes < available);
        let (target, all) = (solver.tolerance.ln(), forces.len() as f64);
        let mut solutions = Vec::with_capacity(forces.len());
        for some in forces.chunks(if fits { WIDTH } else { 1 }) {
            let (done, now) = (solutions.len() as f64, some.len() as f64);
            let watch: &mut Watch = &mut |event| {
                if let Event::Iteration { residual, .. } = event {
                    // Residuals fall by about the same factor in each iteration, so that their logarithms measure the
                    // way; the first ones may rise.
                    share((done + now * (residual.ln() / target).clamp(0.0, 1.0)) / all);
                }
                ControlFlow::Continue(())
            };
            let some: Vec<&[f64]> = some.iter().map(|force| &force[..]).collect();
            let found = match &self.hierarchy {
                Hierarchy::Plane(levels) => levels.solve_each(&some, solver.tolerance, solver.iterations, watch),
                Hierarchy::Space(levels) => levels.solve_each(&some, solver.tolerance, solver.iterations, watch),
            };
            solutions.extend(found.map_err(|fault| unsolved("conjugate gradients", &fault, solver))?);
        }
        Ok(solutions)
    }

    /// The `count` lowest natural vibrations ([`super::lowest_modes`]), each product with the inverse by iterations.
    /// The stiffness is known to be positive definite.
    ///
    /// # Errors
    /// As there, and the iterations stall: kind `Limit`.
    pub fn lowest_modes<'a>(&self, masses: impl Into<Masses<'a>>, dimension: usize, count: usize) -> Result<Modes> {
        self.modes(masses.into(), dimension, count)
    }

    /// [`Self::lowest_modes`], without parameters of type: compiled here, where code is optimised, and not with each caller.
    fn modes<'a>(&self, masses: Masses<'a>, dimension: usize, count: usize) -> Result<Modes> {
        let free: Vec<usize> = (0..self.prescribed.len()).filter(|dof| self.prescribed[*dof].is_none()).collect();
        let spread = |x: &[f64]| {
            let mut all = vec![0.0; self.prescribed.len()];
            free.iter().zip(x).for_each(|(&dof, x)| all[dof] = *x);
            all
        };
        let gather = |all: &[f64], x: &mut [f64]| free.iter().zip(x).for_each(|(&dof, x)| *x = all[dof]);
        let apply = |x: &[f64]| {
            let mut product = x.to_vec();
            gather(&self.stiffness.apply(&spread(x)), &mut product);
            product
        };
        let solver = StaticSolver { tolerance: MODE_TOLERANCE, ..StaticSolver::default() };
        let solve = |x: &mut [f64]| {
            // A piece of no numbers is a panic, and a body that is held everywhere has none.
            let mut columns: Vec<&mut [f64]> = x.chunks_exact_mut(free.len().max(1)).collect();
            let forces: Vec<Vec<f64>> = columns.iter().map(|x| spread(x)).collect();
            let found = self.respond_all(&forces, &solver)?;
            columns.iter_mut().zip(found).for_each(|(x, found)| gather(&found, x));
            Ok(())
        };
        modes_of(&free, &apply, &solve, masses, dimension, count)
    }

    /// The given displacements, and the forces that these cause.
    fn held(&self, stiffness: &BlockStiffness) -> (Vec<f64>, Vec<f64>) {
        let displacement: Vec<f64> = self.prescribed.iter().map(|u| u.unwrap_or(0.0)).collect();
        let moves = displacement.iter().any(|u| *u != 0.0);
        // Most supports are at rest: a pass over the matrix is spared.
        let reaction = if moves { stiffness.apply(&displacement) } else { vec![0.0; displacement.len()] };
        (displacement, reaction)
    }

    fn told(&self, method: &str, solution: &Solution) -> Solved {
        let levels = match &self.hierarchy {
            Hierarchy::Plane(levels) => levels.levels(),
            Hierarchy::Space(levels) => levels.levels(),
        };
        Solved {
            method: method.into(),
            unknowns: self.size(),
            iterations: Some(solution.iterations),
            residual: solution.residual,
            levels: Some(sizes(levels)),
        }
    }

    /// That no motion is without energy, but with a chance of 1e-12; the motion if there is one.
    ///
    /// # Errors
    /// It cannot be decided: kind `Limit`.
    pub fn prove(&self) -> Result<Option<Vec<f64>>> {
        let watch: &mut Watch = &mut |_| ControlFlow::Continue(());
        let found = match &self.hierarchy {
            Hierarchy::Plane(levels) => levels.definiteness(DOUBT, STEPS, watch),
            Hierarchy::Space(levels) => levels.definiteness(DOUBT, STEPS, watch),
        };
        match found.map_err(|fault| limit(&fault))? {
            Definiteness::Positive { .. } => Ok(None),
            Definiteness::NotPositive { motion, .. } => Ok(Some(motion.displacement)),
            Definiteness::Undecided { least, doubt, iterations } => Err(Error::new(format!(
                "whether the stiffness is positive definite is not decided after {iterations} iterations: its least eigenvalue \
                 relative to the multigrid is {least:.1e}, the chance of one below zero {doubt:.1e}; method = \"cholesky\" decides it"
            ))
            .of_kind(ErrorKind::Limit)),
        }
    }

    fn extreme(
        &self,
        end: End,
        measured: &BlockStiffness,
        by: &BlockStiffness,
        start: Option<&[f64]>,
        steps: usize,
    ) -> Result<Extreme> {
        let watch: &mut Watch = &mut |_| ControlFlow::Continue(());
        let found = match (&self.hierarchy, measured, by) {
            (Hierarchy::Plane(levels), BlockStiffness::Plane(measured), BlockStiffness::Plane(by)) => {
                levels.extreme(end, measured, by, start, steps, watch)
            }
            (Hierarchy::Space(levels), BlockStiffness::Space(measured), BlockStiffness::Space(by)) => {
                levels.extreme(end, measured, by, start, steps, watch)
            }
            _ => return Err(Error::new("expected stiffnesses of one dimension, found two")),
        };
        found.map_err(|fault| limit(&fault))
    }
}

/// The extreme ratios of the energies of a network, with its levels or the motion that shows that it has none, and of a body.
///
/// The network is proved to be positive definite, or not ([`Multigrid::definiteness`]); then the least ratio is sought among all motions,
/// with the levels of the network, or of the body where the network has none. A ratio is always that of a motion.
///
/// # Errors
/// It is not decided whether the network is positive definite, or numbers are not finite: kind `Limit`.
pub fn compare_levels(
    network: std::result::Result<&Levels, &[f64]>,
    stiffness: &BlockStiffness,
    body: &Levels,
) -> Result<Stability> {
    let own = body.stiffness();
    let free = |motion: Vec<f64>| {
        let pairs = motion.into_iter().zip(&body.prescribed);
        pairs.filter_map(|(u, held)| held.is_none().then_some(u)).collect::<Vec<f64>>()
    };
    let shown = match network {
        _ if body.size() == 0 => {
            let (energy_ratio, softest) = ([1.0; 2], Vec::new());
            return Ok(Stability { standing: Standing::Stable, energy_ratio, softest, is_found: true });
        }
        Ok(levels) => levels.prove()?,
        Err(motion) => Some(motion.to_vec()),
    };
    let least = match (network, &shown) {
        // The least ratios are the largest ones of K⁻¹ R, and the levels of the network stand for K⁻¹.
        (Ok(levels), None) => levels.extreme(End::Least, stiffness, own, None, END_STEPS)?,
        (_, start) => body.extreme(End::Least, stiffness, own, start.as_deref(), END_STEPS)?,
    };
    let largest = body.extreme(End::Largest, stiffness, own, None, END_STEPS)?;
    let standing = standing(least.quotient, shown.is_none());
    // Both searches end early, so that the second may stay below what the first has found on a body where all ratios
    // are alike.
    let energy_ratio = [least.quotient, largest.quotient.max(least.quotient)];
    Ok(Stability { standing, energy_ratio, softest: free(least.displacement), is_found: least.is_settled })
}

/// Why the iterations of `method` have given no solution, with what may help.
fn unsolved(method: &str, fault: &Fault, solver: &StaticSolver) -> Error {
    let Fault::Stalled { residual, iterations, levels } = fault else { return limit(fault) };
    let levels = sizes(levels);
    let place = format!("at the relative residual {residual:.1e} after {iterations} iterations (levels: {levels})");
    let help = "a larger solver.tolerance, a mesh with better cells, or solver.method = \"cholesky\" may help";
    if *iterations < solver.iterations {
        return Error::new(format!("{method} stall {place}: {help}")).of_kind(ErrorKind::Limit);
    }
    let problem = format!("{method} stall {place}, which are all that is allowed: more of them, {help}");
    Error::at("solver.iterations", problem).of_kind(ErrorKind::Limit)
}

/// An end of the iterations that says nothing about the model, or one that does.
fn limit(fault: &Fault) -> Error {
    let kind = match fault {
        Fault::NotPositive(_) => ErrorKind::Infeasible,
        Fault::Interrupted | Fault::Stagnant { .. } | Fault::Stalled { .. } | Fault::Size { .. } | Fault::NotFinite => {
            ErrorKind::Limit
        }
    };
    Error::new(fault.to_string()).of_kind(kind)
}
