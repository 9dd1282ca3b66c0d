//! The loads of a scene at small deformation where the equations are too large for a factor: conjugate gradients with multigrid.

use super::answer::{BodyAnswer, NetworkAnswer, check_residual, not_definite, shared};
use super::case::Case;
use crate::error::Result;
use crate::material::{CellMap, Hooke};
use crate::mesh::Mesh;
use crate::model::{BlockStiffness, Network};
use crate::solve::{Levels, Solved, Stability, Standing, StaticSolver, compare_levels};
use crate::study::metrics::{SOLVED, product};
use crate::study::progress::{Event, Progress};
use std::sync::Arc;
use std::time::Instant;

/// The levels of the finite elements under each support.
pub(super) struct Iterated {
    pub systems: Vec<Arc<Levels>>,
    /// Of each load, into these.
    pub system_of: Vec<usize>,
}

/// Steps into which the progress of a solution is divided.
const PARTS: usize = 100;

impl Iterated {
    /// # Errors
    /// Some motion has no stiffness, the equations do not fit into memory, or the iterations stall.
    pub fn solve(
        mesh: &Mesh,
        moduli: &CellMap<Hooke>,
        cases: &[Case],
        solver: &StaticSolver,
        progress: &mut Progress,
    ) -> Result<(Iterated, Vec<BodyAnswer>)> {
        let supports = shared(cases).iter().enumerate().filter(|(i, first)| i == *first).count();
        let start = Instant::now();
        // Those of the body, and of a network.
        let stiffness = BlockStiffness::of_body(mesh, moduli, 2, 2 * supports)?;
        let assembly = start.elapsed().as_secs_f64();
        let (mut iterated, mut answers) = (Iterated { systems: Vec::new(), system_of: Vec::new() }, Vec::new());
        let mut setup = Vec::new();
        for (i, (case, first)) in cases.iter().zip(shared(cases)).enumerate() {
            if first == i {
                let start = Instant::now();
                let levels =
                    Levels::new(stiffness.clone(), &mesh.points, &case.support).map_err(|e| e.at_key("mesh"))?;
                let levels = levels.map_err(|_| not_definite(mesh))?;
                if levels.prove().map_err(|e| e.at_key("mesh"))?.is_some() {
                    return Err(not_definite(mesh));
                }
                iterated.systems.push(Arc::new(levels));
                iterated.system_of.push(iterated.systems.len() - 1);
                setup.push(start.elapsed().as_secs_f64());
            } else {
                iterated.system_of.push(iterated.system_of[first]);
            }
            let system = iterated.system_of[i];
            let start = Instant::now();
            let (u, solved) =
                solution(&iterated.systems[system], case, solver, ("finite elements", i, cases.len()), progress)?;
            let work = case.work(&u, || Some(product(&stiffness.apply(&u), &u)));
            let seconds = assembly + setup[system] + start.elapsed().as_secs_f64();
            answers.push(BodyAnswer { displacement: u, work, seconds, solved });
        }
        progress(Event::stage("finite elements", PARTS * cases.len(), PARTS * cases.len()));
        Ok((iterated, answers))
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
        let start = Instant::now();
        let shared = self.systems[0].stiffness();
        let stiffness = BlockStiffness::of_network(network, &mesh.points, Some(shared));
        let assembly = start.elapsed().as_secs_f64();
        let other = (compared != moduli).then(|| BlockStiffness::of_body(mesh, compared, 1, 1)).transpose()?;
        let (mut answers, mut first) = (Vec::new(), None);
        let mut systems: Vec<(std::result::Result<Levels, Vec<f64>>, Standing, f64)> = Vec::new();
        for (i, case) in cases.iter().enumerate() {
            let index = self.system_of[i];
            if index == systems.len() {
                let start = Instant::now();
                let levels =
                    Levels::new(stiffness.clone(), &mesh.points, &case.support).map_err(|e| e.at_key("mesh"))?;
                let seconds = start.elapsed().as_secs_f64();
                let other = other.as_ref().map(|other| Levels::new(other.clone(), &mesh.points, &case.support));
                let other = match other.transpose()? {
                    Some(Err(_)) => return Err(not_definite(mesh)),
                    Some(Ok(levels)) => Some(levels),
                    None => None,
                };
                let body = other.as_ref().unwrap_or(&*self.systems[index]);
                let found = compare_levels(levels.as_ref().map_err(|motion| &motion[..]), &stiffness, body)?;
                systems.push((levels, found.standing, seconds));
                first.get_or_insert(found);
            }
            let (levels, standing, setup) = &systems[index];
            let start = Instant::now();
            let (mut displacement, mut work, mut how) = (None, None, None);
            let found = match (levels, standing) {
                (_, Standing::Singular) => None,
                (Ok(levels), Standing::Stable | Standing::Soft) => {
                    Some(solution(levels, case, solver, ("networks", i, cases.len()), progress)?)
                }
                // An equilibrium that is not stable; where it is not found, there is none to show.
                (_, Standing::Indefinite | Standing::Stable | Standing::Soft) => {
                    let found = self.systems[index].solve_other(&stiffness, &case.forces, solver);
                    found.ok().filter(|(_, solved)| solved.residual <= SOLVED)
                }
            };
            if let Some((u, solved)) = found {
                work = case.work(&u, || Some(product(&stiffness.apply(&u), &u)));
                (displacement, how) = (Some(u), Some(solved));
            }
            let seconds = assembly + setup + start.elapsed().as_secs_f64();
            answers.push(NetworkAnswer { displacement, work, seconds, solved: how });
        }
        let stability = first.expect("there is a load");
        Ok((answers, stability))
    }
}

/// The displacements under a load, with word of how far they are; `(stage, load, loads)`.
fn solution(
    levels: &Levels,
    case: &Case,
    solver: &StaticSolver,
    (stage, load, loads): (&str, usize, usize),
    progress: &mut Progress,
) -> Result<(Vec<f64>, Solved)> {
    progress(Event::stage(stage, PARTS * load, PARTS * loads));
    let mut share = |part: f64| {
        progress(Event::stage(stage, PARTS * load + (part * (PARTS - 1) as f64) as usize, PARTS * loads));
    };
    let (u, solved) = levels.solve(&case.forces, solver, &mut share).map_err(|e| e.at_key("mesh"))?;
    check_residual(solved.residual, case)?;
    Ok((u, solved))
}
