//! The loads of a scene at small deformation: one linear system per model and support.

use super::case::Case;
use super::iterated::Iterated;
use crate::error::{Error, ErrorKind, Result};
use crate::material::Moduli;
use crate::mesh::Mesh;
use crate::model::Network;
use crate::model::{Support, check_body, finite_elements};
use crate::solve::{Factor, Solved, Stability, Standing, StaticMethod, StaticSolver, System, compare_energies};
use crate::study::metrics::{SOLVED, square};
use crate::study::outcome::LoadOutcome;
use crate::study::progress::{Event, Progress};
use std::time::Instant;

/// The finite element solutions, and the parts of them that the comparison with a network reuses.
pub struct LinearBody {
    pub displacements: Vec<Vec<f64>>,
    /// The work of each load, J; see [`Case::work`].
    works: Vec<Option<f64>>,
    solved: Vec<Solved>,
    moduli: Moduli,
    seconds: Vec<f64>,
    solver: StaticSolver,
    systems: Systems,
    /// The equations of each load, as an index into these: loads of equal support share them.
    system_of: Vec<usize>,
}

/// Equations with what solves them.
enum Systems {
    Factored(Vec<(System, Factor)>),
    Iterated(Iterated),
}

/// The results of a network under all loads.
#[derive(Default)]
pub struct NetworkAnswers {
    pub loads: Vec<LoadOutcome>,
    /// The stability with the support of the first load; `None` without loads.
    pub stability: Option<Stability>,
    /// The points whose displacement in the softest motion is at least half of the largest.
    pub loose_points: Vec<usize>,
}

/// The answer of a network to one load.
pub(super) struct NetworkAnswer {
    pub displacement: Option<Vec<f64>>,
    /// J; see [`Case::work`].
    pub work: Option<f64>,
    pub seconds: f64,
    pub solved: Option<Solved>,
}

/// For each load the first load with the same support, whose equations it shares.
pub(super) fn shared(cases: &[Case]) -> Vec<usize> {
    let first = |case: &Case| cases.iter().position(|c| c.support == case.support).unwrap_or(0);
    cases.iter().map(first).collect()
}

impl LinearBody {
    /// Solves every load.
    ///
    /// # Errors
    /// Some motion has no stiffness, the equations do not fit into memory, or iterations that were asked for stall.
    pub fn solve(
        mesh: &Mesh,
        moduli: Moduli,
        cases: &[Case],
        solver: StaticSolver,
        progress: &mut Progress,
    ) -> Result<LinearBody> {
        if !cases.is_empty() && solver.iterates(mesh, cases.len()) {
            return match LinearBody::iterate(mesh, moduli, cases, solver, progress) {
                Err(error) if solver.gives_way(&error) => {
                    progress(Event::Note(&format!("{}; the equations are factorised instead", error.problem())));
                    LinearBody::factorize(mesh, moduli, cases, solver, progress)
                }
                other => other,
            };
        }
        LinearBody::factorize(mesh, moduli, cases, solver, progress)
    }

    fn iterate(
        mesh: &Mesh,
        moduli: Moduli,
        cases: &[Case],
        solver: StaticSolver,
        progress: &mut Progress,
    ) -> Result<LinearBody> {
        let (iterated, answers) = Iterated::solve(mesh, moduli, cases, &solver, progress)?;
        let (mut displacements, mut works, mut seconds, mut solved) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for answer in answers {
            displacements.push(answer.displacement);
            works.push(answer.work);
            seconds.push(answer.seconds);
            solved.push(answer.solved);
        }
        let system_of = iterated.system_of.clone();
        Ok(LinearBody {
            displacements,
            works,
            solved,
            moduli,
            seconds,
            solver,
            systems: Systems::Iterated(iterated),
            system_of,
        })
    }

    fn factorize(
        mesh: &Mesh,
        moduli: Moduli,
        cases: &[Case],
        solver: StaticSolver,
        progress: &mut Progress,
    ) -> Result<LinearBody> {
        let mut body = LinearBody {
            displacements: Vec::new(),
            works: Vec::new(),
            solved: Vec::new(),
            moduli,
            seconds: Vec::new(),
            solver,
            systems: Systems::Factored(Vec::new()),
            system_of: Vec::new(),
        };
        if cases.is_empty() {
            return Ok(body);
        }
        let mut systems: Vec<(System, Factor)> = Vec::new();
        check_body(mesh)?;
        let start = Instant::now();
        let entries = finite_elements(mesh, moduli);
        let assembly = start.elapsed().as_secs_f64();
        let mut setup = Vec::new();
        for (i, (case, first)) in cases.iter().zip(shared(cases)).enumerate() {
            progress(Event::stage("finite elements", i, cases.len()));
            if first == i {
                let start = Instant::now();
                let system = System::new(&entries, &case.support)?;
                let factor = definite(&system, mesh)?;
                systems.push((system, factor));
                body.system_of.push(systems.len() - 1);
                setup.push(start.elapsed().as_secs_f64());
            } else {
                body.system_of.push(body.system_of[first]);
            }
            let (system, factor) = &systems[body.system_of[i]];
            let start = Instant::now();
            let (u, residual) = system.solve(factor, &case.forces);
            if !(residual <= SOLVED) {
                let expected = format!("equations that can be solved to {SOLVED:.0e} of the forces");
                return Err(Error::expected(
                    "mesh",
                    expected,
                    format!("{residual:.1e} left under load \"{}\"", case.name),
                ));
            }
            body.seconds.push(assembly + setup[body.system_of[i]] + start.elapsed().as_secs_f64());
            body.works.push(case.work(&u, || Some(square(&entries, &u))));
            body.solved.push(by_factor(factor, system, residual));
            body.displacements.push(u);
        }
        body.systems = Systems::Factored(systems);
        progress(Event::stage("finite elements", cases.len(), cases.len()));
        Ok(body)
    }

    /// The equations and factor of the loads with this support, if there are any.
    pub fn held_by(&self, support: &Support, cases: &[Case]) -> Option<&(System, Factor)> {
        let load = cases.iter().position(|case| case.support == *support)?;
        match &self.systems {
            Systems::Factored(systems) => Some(&systems[self.system_of[load]]),
            Systems::Iterated(_) => None,
        }
    }

    /// Solves every load with the network. Its energies are compared with those of finite elements with the moduli
    /// `compared`.
    ///
    /// # Errors
    /// The equations do not fit into memory, or iterations that were asked for stall.
    pub fn compare(
        &self,
        mesh: &Mesh,
        cases: &[Case],
        network: &Network,
        compared: Moduli,
        progress: &mut Progress,
    ) -> Result<NetworkAnswers> {
        match &self.systems {
            _ if cases.is_empty() => Ok(NetworkAnswers::default()),
            Systems::Factored(systems) => self.compare_factored(systems, mesh, cases, network, compared),
            Systems::Iterated(iterated) => {
                match iterated.compare(mesh, cases, network, (self.moduli, compared), &self.solver, progress) {
                    Ok((answers, stability)) => {
                        let loads = answers.into_iter().enumerate();
                        let loads = loads.map(|(i, answer)| self.outcome(i, &cases[i], mesh, answer)).collect();
                        let free: Vec<usize> =
                            (0..mesh.points.len()).filter(|dof| !cases[0].support.is_fixed(*dof)).collect();
                        let loose_points = moving_points(&free, &stability, mesh.dimension);
                        Ok(NetworkAnswers { loads, stability: Some(stability), loose_points })
                    }
                    Err(error) if self.solver.gives_way(&error) => {
                        progress(Event::Note(&format!("{}; the equations are factorised instead", error.problem())));
                        let solver = StaticSolver { method: StaticMethod::Cholesky, ..self.solver };
                        let body = LinearBody::factorize(mesh, self.moduli, cases, solver, progress)?;
                        body.compare(mesh, cases, network, compared, progress)
                    }
                    Err(error) => Err(error),
                }
            }
        }
    }

    /// The answer of a network to the load of this number.
    fn outcome(&self, i: usize, case: &Case, mesh: &Mesh, answer: NetworkAnswer) -> LoadOutcome {
        let NetworkAnswer { displacement, work, seconds, solved } = answer;
        LoadOutcome {
            name: case.name.clone(),
            error: displacement.as_ref().and_then(|u| case.error(&self.displacements[i], u, mesh.dimension)),
            work_error: case.work_error(self.works[i], work),
            displacement,
            seconds_fem: self.seconds[i],
            seconds_lem: seconds,
            solved_fem: Some(self.solved[i].clone()),
            solved_lem: solved,
            followed: None,
            gauge: None,
        }
    }

    fn compare_factored(
        &self,
        bodies: &[(System, Factor)],
        mesh: &Mesh,
        cases: &[Case],
        network: &Network,
        compared: Moduli,
    ) -> Result<NetworkAnswers> {
        let mut answers = NetworkAnswers::default();
        network.check_size()?;
        let start = Instant::now();
        let entries = network.stiffness(&mesh.points);
        let assembly = start.elapsed().as_secs_f64();
        let other = (compared != self.moduli).then(|| finite_elements(mesh, compared));
        let mut systems: Vec<(System, Option<Factor>, Stability, f64)> = Vec::new();
        for (i, case) in cases.iter().enumerate() {
            let index = self.system_of[i];
            if index == systems.len() {
                let start = Instant::now();
                let system = System::new(&entries, &case.support)?;
                let factor = system.factorize().map_err(|e| e.at_key("mesh"))?;
                let seconds = start.elapsed().as_secs_f64();
                let (body, body_factor) = &bodies[index];
                let other = other.as_ref().map(|entries| body.renewed(entries, &case.support)).transpose()?;
                let other = other.map(|body| definite(&body, mesh).map(|factor| (body, factor))).transpose()?;
                let (body, body_factor) = other.as_ref().map_or((body, body_factor), |(body, factor)| (body, factor));
                let stability = compare_energies(&system, factor.as_ref(), body, body_factor);
                systems.push((system, factor, stability, seconds));
            }
            let (system, factor, stability, setup) = &systems[index];
            let start = Instant::now();
            let stands = stability.standing != Standing::Singular;
            let solution = factor.as_ref().filter(|_| stands).map(|factor| system.solve(factor, &case.forces));
            let seconds_lem = assembly + setup + start.elapsed().as_secs_f64();
            let solved = solution.filter(|(u, residual)| *residual <= SOLVED && u.iter().all(|u| u.is_finite()));
            let how = |(_, residual): &(Vec<f64>, f64)| Some(by_factor(factor.as_ref()?, system, *residual));
            let how = solved.as_ref().and_then(how);
            let displacement = solved.map(|(u, _)| u);
            let work = displacement.as_ref().and_then(|u| case.work(u, || Some(square(&entries, u))));
            let answer = NetworkAnswer { displacement, work, seconds: seconds_lem, solved: how };
            answers.loads.push(self.outcome(i, case, mesh, answer));
        }
        if let Some((system, _, stability, _)) = systems.into_iter().next() {
            answers.loose_points = moving_points(system.free(), &stability, mesh.dimension);
            answers.stability = Some(stability);
        }
        Ok(answers)
    }
}

fn by_factor(factor: &Factor, system: &System, residual: f64) -> Solved {
    let method = if factor.is_positive_definite() { "cholesky" } else { "lu" };
    Solved { method, unknowns: system.size(), iterations: None, residual, levels: None }
}

/// The Cholesky factor of the equations of the finite elements.
///
/// # Errors
/// Some motion has no stiffness, or the factor does not fit into memory.
fn definite(system: &System, mesh: &Mesh) -> Result<Factor> {
    let factor = system.cholesky().map_err(|e| e.at_key("mesh"))?;
    factor.ok_or_else(|| not_definite(mesh))
}

/// Of finite elements.
pub(super) fn not_definite(mesh: &Mesh) -> Error {
    let why = "the finite element stiffness is not positive definite: some motion has no stiffness";
    let bending = "; surfaces and curves resist no bending, so hold their points across them";
    let embedded = mesh.cell_dimension() < mesh.dimension;
    Error::at("mesh", format!("{why}{}", if embedded { bending } else { "" })).of_kind(ErrorKind::Infeasible)
}

fn moving_points(free: &[usize], stability: &Stability, dimension: usize) -> Vec<usize> {
    if stability.standing == Standing::Stable {
        return Vec::new();
    }
    let mut squares = std::collections::BTreeMap::new();
    for (dof, u) in free.iter().zip(&stability.softest) {
        *squares.entry(dof / dimension).or_insert(0.0) += u * u;
    }
    let largest = squares.values().copied().fold(0.0, f64::max);
    squares.into_iter().filter(|(_, s)| *s >= 0.25 * largest).map(|(p, _)| p).collect()
}
