//! The loads of a scene at small deformation where the equations are too large for a factor: conjugate gradients with multigrid.

use super::case::Case;
use super::linear_answers::{BodyAnswer, NetworkAnswer, check_residual, largest_residual, not_definite, shared};
use crate::analysis::metrics::product;
use crate::clock::Clock;
use crate::error::{Error, Result};
use crate::material::{CellMap, Hooke};
use crate::mesh::Mesh;
use crate::model::{BlockStiffness, Network};
use crate::progress::{Event, Progress};
use crate::solve::{Levels, Solved, Stability, Standing, StaticSolver, compare_levels};
use std::sync::Arc;

/// The levels of the finite elements under each support.
pub(super) struct Iterated {
    pub systems: Vec<Arc<Levels>>,
    /// Each load has its levels at this index of `systems`, `[loads]`.
    pub system_of: Vec<usize>,
}

/// Why a network that is not positive definite has no displacements here.
const UNSTABLE: &str = "iterations end at a motion that releases energy; method = \"cholesky\" in [solver] finds the unstable equilibrium of a body \
                        whose factor fits into memory";
/// Steps into which the progress of a solution is divided.
const PARTS: usize = 100;

impl Iterated {
    /// Whether the equations with their levels fit into memory.
    ///
    /// # Errors
    /// They do not: kind `Limit`.
    pub fn check_size(mesh: &Mesh, cases: &[Case]) -> Result<()> {
        BlockStiffness::check_size(mesh, 2, 2 * groups(cases).len())
    }

    /// # Errors
    /// Some motion has no stiffness, the equations do not fit into memory, or the iterations stall.
    pub fn solve(
        mesh: &Mesh,
        moduli: &CellMap<Hooke>,
        cases: &[Case],
        solver: &StaticSolver,
        progress: &mut Progress,
    ) -> Result<(Iterated, Vec<BodyAnswer>)> {
        let start = Clock::start();
        // Those of the body, and of a network.
        let stiffness = BlockStiffness::of_body(mesh, moduli, 2, 2 * groups(cases).len())?;
        let assembly = start.seconds();
        let mut iterated = Iterated { systems: Vec::new(), system_of: vec![0; cases.len()] };
        let mut answers: Vec<Option<BodyAnswer>> = cases.iter().map(|_| None).collect();
        let mut done = 0;
        for group in groups(cases) {
            let start = Clock::start();
            let support = &cases[group[0]].support;
            let levels = Levels::new(stiffness.clone(), &mesh.points, support).map_err(|e| e.at_key("mesh"))?;
            let levels = levels.map_err(|_| not_definite(mesh))?;
            // Levels may be built of a matrix that is not definite, and iterations may end on it: a factor would have
            // told.
            if levels.prove().map_err(|e| e.at_key("mesh"))?.is_some() {
                return Err(not_definite(mesh));
            }
            let setup = start.seconds();
            let solutions = solutions(&levels, cases, &group, solver, ("finite elements", done), progress)?;
            for (&i, Solution { displacement, solved, seconds }) in group.iter().zip(solutions) {
                let work =
                    cases[i].work(&displacement, || Some(product(&stiffness.apply(&displacement), &displacement)));
                let seconds = assembly + setup + seconds;
                answers[i] = Some(BodyAnswer { displacement, work, seconds, solved });
                iterated.system_of[i] = iterated.systems.len();
            }
            done += group.len();
            iterated.systems.push(Arc::new(levels));
        }
        progress(Event::stage("finite elements", PARTS * cases.len(), PARTS * cases.len()));
        Ok((iterated, answers.into_iter().map(|answer| answer.expect("each load has a support")).collect()))
    }

    /// The answers of a network to all loads, and its stability under the support of the first; its energies are compared with those of
    /// finite elements of the second moduli, the first are those of this body.
    ///
    /// # Errors
    /// The equations do not fit into memory, the iterations stall, or it is not decided whether the network is stable.
    pub fn compare(
        &self,
        mesh: &Mesh,
        cases: &[Case],
        network: &Network,
        (moduli, compared): (&CellMap<Hooke>, &CellMap<Hooke>),
        solver: &StaticSolver,
        progress: &mut Progress,
    ) -> Result<(Vec<NetworkAnswer>, Stability)> {
        let start = Clock::start();
        let shared = self.systems[0].stiffness();
        let stiffness = BlockStiffness::of_network(network, &mesh.points, Some(shared));
        let assembly = start.seconds();
        let other = (compared != moduli).then(|| BlockStiffness::of_body(mesh, compared, 1, 1)).transpose()?;
        let mut answers: Vec<Option<NetworkAnswer>> = cases.iter().map(|_| None).collect();
        let (mut first, mut done) = (None, 0);
        for (system, group) in self.systems.iter().zip(groups(cases)) {
            let start = Clock::start();
            let support = &cases[group[0]].support;
            let levels = Levels::new(stiffness.clone(), &mesh.points, support).map_err(|e| e.at_key("mesh"))?;
            let setup = assembly + start.seconds();
            let other = other.as_ref().map(|other| Levels::new(other.clone(), &mesh.points, support));
            let other = match other.transpose()? {
                Some(Err(_)) => return Err(not_definite(mesh)),
                Some(Ok(levels)) => Some(levels),
                None => None,
            };
            let body = other.as_ref().unwrap_or(system);
            let found = compare_levels(levels.as_ref().map_err(|motion| &motion[..]), &stiffness, body)?;
            let standing = found.standing;
            first.get_or_insert(found);
            let solutions: Vec<std::result::Result<Solution, Option<String>>> = match (&levels, standing) {
                (_, Standing::Singular) => group.iter().map(|_| Err(None)).collect(),
                (Ok(levels), Standing::Stable | Standing::Soft) => {
                    let found = solutions(levels, cases, &group, solver, ("networks", done), progress)?;
                    found.into_iter().map(Ok).collect()
                }
                // Of a network that releases energy only the direction is sought: its equilibrium is not stable, and minimal residuals take
                // many times as long as all else of a run, mostly without an end.
                (_, Standing::Indefinite | Standing::Stable | Standing::Soft) => {
                    group.iter().map(|_| Err(Some(UNSTABLE.into()))).collect()
                }
            };
            for (&i, found) in group.iter().zip(solutions) {
                let (mut work, mut seconds) = (None, setup);
                if let Ok(Solution { displacement: u, seconds: own, .. }) = &found {
                    work = cases[i].work(u, || Some(product(&stiffness.apply(u), u)));
                    seconds += own;
                }
                let (displacement, solved, unsolved) = match found {
                    Ok(found) => (Some(found.displacement), Some(found.solved), None),
                    Err(why) => (None, None, why),
                };
                answers[i] = Some(NetworkAnswer { displacement, work, seconds, solved, unsolved });
            }
            done += group.len();
        }
        let stability = first.expect("there is a load");
        Ok((answers.into_iter().map(|answer| answer.expect("each load has a support")).collect(), stability))
    }
}

/// The loads of each support, in the order in which the supports come.
fn groups(cases: &[Case]) -> Vec<Vec<usize>> {
    let first = shared(cases);
    let of = |i: usize| (i..cases.len()).filter(|k| first[*k] == i).collect();
    (0..cases.len()).filter(|i| first[*i] == *i).map(of).collect()
}

/// The error at the mesh, unless another key is at fault.
fn keyed(error: Error) -> Error {
    if error.key().is_some() { error } else { error.at_key("mesh") }
}

/// The displacements under a load, how they were found, and the share of this load in the time that its group took.
struct Solution {
    displacement: Vec<f64>,
    solved: Solved,
    seconds: f64,
}

/// The displacements under the loads of a group, side by side, with word of how far they are; `(stage, loads done before)`.
fn solutions(
    levels: &Levels,
    cases: &[Case],
    group: &[usize],
    solver: &StaticSolver,
    (stage, done): (&str, usize),
    progress: &mut Progress,
) -> Result<Vec<Solution>> {
    let all = PARTS * cases.len();
    progress(Event::stage(stage, PARTS * done, all));
    // The stage ends where its caller says so.
    let mut share = |part: f64| {
        let now = PARTS * done + (part * (PARTS * group.len()) as f64) as usize;
        progress(Event::stage(stage, now.min(all - 1), all));
    };
    let start = Clock::start();
    let forces: Vec<&[f64]> = group.iter().map(|&i| &cases[i].forces[..]).collect();
    let found = levels.solve_each(&forces, solver, &mut share).map_err(keyed)?;
    // Loads side by side have no times of their own.
    let seconds = start.seconds() / group.len() as f64;
    let checked = |(&i, (displacement, solved)): (&usize, (Vec<f64>, Solved))| {
        check_residual(solved.residual, largest_residual(solver), &cases[i].name)?;
        Ok(Solution { displacement, solved, seconds })
    };
    group.iter().zip(found).map(checked).collect()
}
