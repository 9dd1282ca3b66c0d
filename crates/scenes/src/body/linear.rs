//! The loads of a scene at small deformation: one linear system per model and support, solved by factors or by iterations.

use super::case::Case;
use super::factored::Factored;
use super::iterated::Iterated;
use super::linear_answers::{BodyAnswer, NetworkAnswer, shared};
use crate::engine::{Setting, Truncated, TruncatedModel};
use crate::error::{ErrorKind, Result};
use crate::material::{CellMap, Hooke};
use crate::mesh::Mesh;
use crate::model::{Network, Support};
use crate::number::finite;
use crate::outcome::LoadOutcome;
use crate::progress::{Event, Progress};
use crate::solve::{Equations, Stability, Standing, StaticMethod, StaticSolver};
use std::sync::Arc;

/// The finite element solutions, and the parts of them that the comparison with a network reuses.
pub struct LinearBody {
    answers: Vec<BodyAnswer>,
    moduli: CellMap<Hooke>,
    solver: StaticSolver,
    systems: Systems,
}

/// Equations with what solves them.
enum Systems {
    Factored(Factored),
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

impl LinearBody {
    /// Solves every load.
    ///
    /// # Errors
    /// Some motion has no stiffness, the equations do not fit into memory, or iterations that were asked for stall.
    pub fn solve(
        mesh: &Mesh,
        moduli: &CellMap<Hooke>,
        cases: &[Case],
        solver: StaticSolver,
        progress: &mut Progress,
    ) -> Result<LinearBody> {
        let solver = solver.suited(mesh, moduli);
        if !cases.is_empty() && solver.iterates(mesh, cases.len()) {
            if let Err(error) = Iterated::check_size(mesh, cases) {
                if !solver.gives_way(&error) {
                    return Err(error);
                }
                // The factor of a slender body may be the smaller one. If it is not, what the levels take is the least that would do.
                let factorized = LinearBody::factorize(mesh, moduli, cases, solver, progress);
                return match factorized {
                    Err(other) if other.kind() == ErrorKind::Limit => {
                        Err(error.followed_by("; a factor does not fit either"))
                    }
                    factorized => factorized,
                };
            }
            match Iterated::solve(mesh, moduli, cases, &solver, progress) {
                Ok((iterated, answers)) => {
                    return Ok(LinearBody {
                        answers,
                        moduli: moduli.clone(),
                        solver,
                        systems: Systems::Iterated(iterated),
                    });
                }
                Err(error) if solver.gives_way(&error) => {
                    progress(Event::Note(&format!("{}; the equations are factorised instead", error.problem())));
                }
                Err(error) => return Err(error),
            }
        }
        LinearBody::factorize(mesh, moduli, cases, solver, progress)
    }

    fn factorize(
        mesh: &Mesh,
        moduli: &CellMap<Hooke>,
        cases: &[Case],
        solver: StaticSolver,
        progress: &mut Progress,
    ) -> Result<LinearBody> {
        let (factored, answers) = Factored::solve(mesh, moduli, cases, progress)?;
        Ok(LinearBody { answers, moduli: moduli.clone(), solver, systems: Systems::Factored(factored) })
    }

    /// The displacements under each load.
    pub fn displacements(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.answers.iter().map(|answer| &answer.displacement)
    }

    /// The displacements under each load and their work, J (see [`Case::work`]), without the equations.
    pub fn into_answers(self) -> (Vec<Vec<f64>>, Vec<Option<f64>>) {
        self.answers.into_iter().map(|answer| (answer.displacement, answer.work)).unzip()
    }

    /// The equations of each support of the loads.
    pub fn held<'a>(&'a self, cases: &'a [Case]) -> impl Iterator<Item = (Support, Equations)> + 'a {
        shared(cases).into_iter().enumerate().filter(|(load, first)| load == first).map(|(load, _)| {
            let equations = match &self.systems {
                Systems::Factored(factored) => {
                    let (system, factor) = &factored.systems[factored.system_of[load]];
                    Equations::Factored(system.clone(), factor.clone())
                }
                Systems::Iterated(iterated) => {
                    Equations::Iterated(iterated.systems[iterated.system_of[load]].clone(), self.solver)
                }
            };
            (cases[load].support.clone(), equations)
        })
    }

    /// Solves every load with the network, or moves it to rest in an engine with its masses, `[points]`, kg. Its energies are compared with those of finite elements with the moduli
    /// `compared`.
    ///
    /// # Errors
    /// The equations do not fit into memory, or iterations that were asked for stall.
    pub fn compare(
        &self,
        mesh: &Mesh,
        cases: &[Case],
        (network, engine): (&Network, Option<(Setting, &[f64])>),
        compared: &CellMap<Hooke>,
        progress: &mut Progress,
    ) -> Result<NetworkAnswers> {
        if cases.is_empty() {
            return Ok(NetworkAnswers::default());
        }
        let moduli = (&self.moduli, compared);
        let found = match &self.systems {
            Systems::Factored(factored) => factored.compare(mesh, cases, network, moduli),
            Systems::Iterated(iterated) => iterated.compare(mesh, cases, network, moduli, &self.solver, progress),
        };
        let (answers, stability) = match found {
            Err(error) if matches!(self.systems, Systems::Iterated(_)) && self.solver.gives_way(&error) => {
                progress(Event::Note(&format!("{}; the equations are factorised instead", error.problem())));
                let solver = StaticSolver { method: StaticMethod::Cholesky, ..self.solver };
                // Both models by the same method: the difference of two would have the residuals of iterations in it.
                let body = LinearBody::factorize(mesh, &self.moduli, cases, solver, progress)?;
                return body.compare(mesh, cases, (network, engine), compared, progress);
            }
            other => other?,
        };
        let answers = match engine {
            Some(engine) => in_engine(mesh, cases, (network, engine), answers)?,
            None => answers,
        };
        let loads = self.answers.iter().zip(answers).zip(cases);
        let loads = loads.map(|((body, network), case)| outcome(mesh, (body, network), case)).collect();
        let loose_points = moving_points(&cases[0].support, &stability, mesh);
        Ok(NetworkAnswers { loads, stability: Some(stability), loose_points })
    }
}

/// The answers with the displacements of the network at rest in an engine.
fn in_engine(
    mesh: &Mesh,
    cases: &[Case],
    (network, (setting, masses)): (&Network, (Setting, &[f64])),
    answers: Vec<NetworkAnswer>,
) -> Result<Vec<NetworkAnswer>> {
    let model = TruncatedModel { network, points: &mesh.points, masses };
    let mut known: Vec<(&Support, Option<Truncated>)> = Vec::new();
    let mut all = Vec::new();
    for (case, answer) in cases.iter().zip(answers) {
        if case.is_prescribed {
            let unsolved = Some("supports that move are not solved in an engine".into());
            all.push(NetworkAnswer { displacement: None, work: None, unsolved, ..answer });
            continue;
        }
        // Loads of one support share one matrix, which is dear.
        if known.iter().all(|(support, _)| **support != case.support) {
            known.push((&case.support, Truncated::new(model, &case.support, &setting)?));
        }
        let truncated =
            known.iter().find(|(support, _)| **support == case.support).and_then(|(_, found)| found.as_ref());
        let found = truncated.map(|truncated| truncated.answers(std::slice::from_ref(&case.forces))).transpose()?;
        let displacement = found.and_then(|mut found| found.pop());
        // Prescribed displacements were left out above, so that the work is that of forces.
        let work = displacement.as_ref().and_then(|u| case.work(u, || None));
        all.push(NetworkAnswer { displacement, work, ..answer });
    }
    Ok(all)
}

/// The answer of a network to a load beside that of the finite elements.
fn outcome(mesh: &Mesh, (body, network): (&BodyAnswer, NetworkAnswer), case: &Case) -> LoadOutcome {
    let NetworkAnswer { displacement, work, seconds, solved, unsolved } = network;
    LoadOutcome {
        name: case.name.clone(),
        error: displacement.as_ref().and_then(|u| case.error(mesh, &body.displacement, u)),
        largest_displacement: displacement.as_ref().and_then(|u| finite(mesh.largest_motion(u))),
        work_error: case.work_error(body.work, work),
        displacement: displacement.map(Arc::new),
        seconds_fem: body.seconds,
        seconds_lem: seconds,
        solved_fem: Some(body.solved.clone()),
        solved_lem: solved,
        unsolved,
        ..LoadOutcome::default()
    }
}

fn moving_points(support: &Support, stability: &Stability, mesh: &Mesh) -> Vec<usize> {
    if stability.standing == Standing::Stable {
        return Vec::new();
    }
    let free = (0..mesh.points.len()).filter(|dof| !support.is_fixed(*dof));
    let mut squares = std::collections::BTreeMap::new();
    for (dof, u) in free.zip(&stability.softest) {
        *squares.entry(dof / mesh.dimension).or_insert(0.0) += u * u;
    }
    let largest = squares.values().copied().fold(0.0, f64::max);
    // Points that move by at least half as far as the farthest one show where a soft motion is.
    squares.into_iter().filter(|(_, s)| *s >= 0.25 * largest).map(|(p, _)| p).collect()
}
