//! The loads of a scene at small deformation: one linear system per model and support.

use super::case::Case;
use crate::error::{Error, ErrorKind, Result};
use crate::material::Moduli;
use crate::mesh::Mesh;
use crate::model::Network;
use crate::model::{Support, check_body, finite_elements};
use crate::solve::{Factor, Stability, Standing, System, compare_energies};
use crate::study::metrics::{SOLVED, square};
use crate::study::outcome::LoadOutcome;
use crate::study::progress::{Event, Progress};
use std::time::Instant;

/// The finite element solutions, and the parts of them that the comparison with a network reuses.
pub struct LinearBody {
    pub displacements: Vec<Vec<f64>>,
    /// The work of each load, J; see [`Case::work`].
    works: Vec<Option<f64>>,
    moduli: Moduli,
    seconds: Vec<f64>,
    /// Equations and factors. Each load has an index into them; loads with the same support share them.
    systems: Vec<(System, Factor)>,
    system_of: Vec<usize>,
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

/// For each load the first load with the same support, whose equations it shares.
fn shared(cases: &[Case]) -> Vec<usize> {
    let first = |case: &Case| cases.iter().position(|c| c.support == case.support).unwrap_or(0);
    cases.iter().map(first).collect()
}

impl LinearBody {
    /// Solves every load.
    ///
    /// # Errors
    /// Some motion has no stiffness, or the equations do not fit into memory.
    pub fn solve(mesh: &Mesh, moduli: Moduli, cases: &[Case], progress: &mut Progress) -> Result<LinearBody> {
        let (displacements, works, seconds, systems, system_of) = Default::default();
        let mut body = LinearBody { displacements, works, moduli, seconds, systems, system_of };
        if cases.is_empty() {
            return Ok(body);
        }
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
                body.systems.push((system, factor));
                body.system_of.push(body.systems.len() - 1);
                setup.push(start.elapsed().as_secs_f64());
            } else {
                body.system_of.push(body.system_of[first]);
            }
            let (system, factor) = &body.systems[body.system_of[i]];
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
            body.displacements.push(u);
        }
        progress(Event::stage("finite elements", cases.len(), cases.len()));
        Ok(body)
    }

    /// The equations and factor of the loads with this support, if there are any.
    pub fn held_by(&self, support: &Support, cases: &[Case]) -> Option<&(System, Factor)> {
        let load = cases.iter().position(|case| case.support == *support)?;
        Some(&self.systems[self.system_of[load]])
    }

    /// Solves every load with the network. Its energies are compared with those of finite elements with the moduli
    /// `compared`.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn compare(&self, mesh: &Mesh, cases: &[Case], network: &Network, compared: Moduli) -> Result<NetworkAnswers> {
        let mut answers = NetworkAnswers::default();
        if cases.is_empty() {
            return Ok(answers);
        }
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
                let (body, body_factor) = &self.systems[index];
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
            let displacement = solution.filter(|(u, residual)| *residual <= SOLVED && u.iter().all(|u| u.is_finite()));
            let displacement = displacement.map(|(u, _)| u);
            let work = displacement.as_ref().and_then(|u| case.work(u, || Some(square(&entries, u))));
            answers.loads.push(LoadOutcome {
                name: case.name.clone(),
                error: displacement.as_ref().and_then(|u| case.error(&self.displacements[i], u, mesh.dimension)),
                work_error: case.work_error(self.works[i], work),
                displacement,
                seconds_fem: self.seconds[i],
                seconds_lem,
                followed: None,
                gauge: None,
            });
        }
        if let Some((system, _, stability, _)) = systems.into_iter().next() {
            answers.loose_points = moving_points(&system, &stability, mesh.dimension);
            answers.stability = Some(stability);
        }
        Ok(answers)
    }
}

/// The Cholesky factor of the equations of the finite elements.
///
/// # Errors
/// Some motion has no stiffness, or the factor does not fit into memory.
fn definite(system: &System, mesh: &Mesh) -> Result<Factor> {
    let factor = system.cholesky().map_err(|e| e.at_key("mesh"))?;
    factor.ok_or_else(|| {
        let why = "the finite element stiffness is not positive definite: some motion has no stiffness";
        let bending = "; surfaces and curves resist no bending, so hold their points across them";
        let embedded = mesh.cell_dimension() < mesh.dimension;
        Error::at("mesh", format!("{why}{}", if embedded { bending } else { "" })).of_kind(ErrorKind::Infeasible)
    })
}

fn moving_points(system: &System, stability: &Stability, dimension: usize) -> Vec<usize> {
    if stability.standing == Standing::Stable {
        return Vec::new();
    }
    let mut squares = std::collections::BTreeMap::new();
    for (dof, u) in system.free().iter().zip(&stability.softest) {
        *squares.entry(dof / dimension).or_insert(0.0) += u * u;
    }
    let largest = squares.values().copied().fold(0.0, f64::max);
    squares.into_iter().filter(|(_, s)| *s >= 0.25 * largest).map(|(p, _)| p).collect()
}
