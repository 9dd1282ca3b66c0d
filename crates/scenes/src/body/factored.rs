//! The loads of a scene at small deformation by sparse factors: one for each model and support.

use super::case::Case;
use super::linear_answers::{BodyAnswer, NetworkAnswer, check_residual, not_definite, shared};
use crate::analysis::metrics::{SOLVED, square};
use crate::clock::Clock;
use crate::error::Result;
use crate::material::{CellMap, Hooke};
use crate::mesh::Mesh;
use crate::model::{Network, check_body, finite_elements};
use crate::progress::{Event, Progress};
use crate::solve::{Factor, Solved, Stability, Standing, System, compare_energies};
use std::sync::Arc;

/// The finite elements under each support, factorised.
#[derive(Default)]
pub(super) struct Factored {
    pub systems: Vec<(Arc<System>, Arc<Factor>)>,
    /// Each load has its equations at this index of `systems`, `[loads]`.
    pub system_of: Vec<usize>,
}

impl Factored {
    /// # Errors
    /// Some motion has no stiffness, the factor does not fit into memory, or the equations are too badly conditioned.
    pub fn solve(
        mesh: &Mesh,
        moduli: &CellMap<Hooke>,
        cases: &[Case],
        progress: &mut Progress,
    ) -> Result<(Factored, Vec<BodyAnswer>)> {
        let (mut factored, mut answers) = (Factored::default(), Vec::new());
        if cases.is_empty() {
            return Ok((factored, answers));
        }
        check_body(mesh)?;
        let start = Clock::start();
        let entries = finite_elements(mesh, moduli);
        let assembly = start.seconds();
        let mut setup = Vec::new();
        for (i, (case, first)) in cases.iter().zip(shared(cases)).enumerate() {
            progress(Event::stage("finite elements", i, cases.len()));
            if first == i {
                let start = Clock::start();
                let system = System::new(&entries, &case.support)?.placed(&mesh.points, mesh.dimension);
                let factor = definite(&system, mesh)?;
                factored.system_of.push(factored.systems.len());
                factored.systems.push((Arc::new(system), Arc::new(factor)));
                setup.push(start.seconds());
            } else {
                factored.system_of.push(factored.system_of[first]);
            }
            let index = factored.system_of[i];
            let (system, factor) = &factored.systems[index];
            let start = Clock::start();
            let (u, residual) = system.solve(factor, &case.forces);
            check_residual(residual, SOLVED, &case.name)?;
            let seconds = assembly + setup[index] + start.seconds();
            let work = case.work(&u, || Some(square(&entries, &u)));
            answers.push(BodyAnswer { displacement: u, work, seconds, solved: by_factor(factor, system, residual) });
        }
        progress(Event::stage("finite elements", cases.len(), cases.len()));
        Ok((factored, answers))
    }

    /// The answers of a network to all loads, and its stability under the support of the first; its energies are compared with those of
    /// finite elements of the second moduli, the first are those of this body. A network that is not positive definite keeps its
    /// stability where its factor does not fit into memory, and has no displacements.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn compare(
        &self,
        mesh: &Mesh,
        cases: &[Case],
        network: &Network,
        (moduli, compared): (&CellMap<Hooke>, &CellMap<Hooke>),
    ) -> Result<(Vec<NetworkAnswer>, Stability)> {
        network.check_size()?;
        let start = Clock::start();
        let entries = network.stiffness(&mesh.points);
        let assembly = start.seconds();
        let other = (compared != moduli).then(|| finite_elements(mesh, compared));
        let mut systems: Vec<(System, Result<Option<Factor>>, Stability, f64)> = Vec::new();
        let mut answers = Vec::new();
        for (i, case) in cases.iter().enumerate() {
            let index = self.system_of[i];
            if index == systems.len() {
                let start = Clock::start();
                let system = System::new(&entries, &case.support)?.placed(&mesh.points, mesh.dimension);
                let factor = match system.cholesky().map_err(|e| e.at_key("mesh"))? {
                    Some(factor) => Ok(Some(factor)),
                    None => system.general(),
                };
                let seconds = start.seconds();
                let (body, body_factor) = (&*self.systems[index].0, &*self.systems[index].1);
                let other = other.as_ref().map(|entries| body.renewed(entries, &case.support)).transpose()?;
                // Energies are compared with those of the moduli that a network is meant for, and displacements with
                // those of this body.
                let other = other.map(|body| definite(&body, mesh).map(|factor| (body, factor))).transpose()?;
                let (body, body_factor) = other.as_ref().map_or((body, body_factor), |(body, factor)| (body, factor));
                let stability =
                    compare_energies(&system, factor.as_ref().ok().and_then(Option::as_ref), body, body_factor);
                systems.push((system, factor, stability, seconds));
            }
            let (system, factor, stability, setup) = &systems[index];
            let start = Clock::start();
            let mut unsolved = factor.as_ref().err().map(|e| e.problem().to_string());
            let factor = factor.as_ref().ok().and_then(Option::as_ref);
            // Rounding alone gives a singular matrix a factor.
            let factor = factor.filter(|_| stability.standing != Standing::Singular);
            let found = factor.map(|factor| (factor, system.solve(factor, &case.forces)));
            let seconds = assembly + setup + start.seconds();
            if let Some((_, (_, residual))) = &found {
                unsolved = (!(*residual <= SOLVED)).then(|| format!("the factor leaves {residual:.1e} of the forces"));
            }
            // A factor of a matrix that is all but singular may leave a small residual of useless displacements: NaN is
            // told apart as well.
            let found = found.filter(|(_, (u, residual))| *residual <= SOLVED && u.iter().all(|u| u.is_finite()));
            let solved = found.as_ref().map(|(factor, (_, residual))| by_factor(factor, system, *residual));
            let displacement = found.map(|(_, (u, _))| u);
            let work = displacement.as_ref().and_then(|u| case.work(u, || Some(square(&entries, u))));
            answers.push(NetworkAnswer { displacement, work, seconds, solved, unsolved });
        }
        let (_, _, stability, _) = systems.into_iter().next().expect("there is a load");
        Ok((answers, stability))
    }
}

fn by_factor(factor: &Factor, system: &System, residual: f64) -> Solved {
    Solved { method: factor.method().into(), unknowns: system.size(), iterations: None, residual, levels: None }
}

/// The Cholesky factor of the equations of the finite elements.
///
/// # Errors
/// Some motion has no stiffness, or the factor does not fit into memory.
fn definite(system: &System, mesh: &Mesh) -> Result<Factor> {
    let factor = system.cholesky().map_err(|e| e.at_key("mesh"))?;
    factor.ok_or_else(|| not_definite(mesh))
}
