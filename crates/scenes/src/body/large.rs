//! The loads of a scene at large deformation: Newton's method on both models.

use super::case::Case;
use crate::analysis::metrics::product;
use crate::clock::Clock;
use crate::error::{Error, ErrorKind, Result};
use crate::material::EnergyMap;
use crate::mesh::{CellIndex, Mesh};
use crate::model::Network;
use crate::model::{Body, Elastic, check_body, displaced};
use crate::number::finite;
use crate::outcome::{Followed, LoadOutcome};
use crate::progress::{Event, Progress};
use crate::solve::{Ending, Equilibrium, Newton, System};
use std::sync::Arc;

/// The finite element solutions of a scene whose material has a law.
pub struct LargeBody {
    /// The energies of the laws.
    pub laws: EnergyMap,
    newton: Newton,
    /// The displacements, one list per load, at the last load that was reached; `[points · dimension]`, m.
    pub displacements: Vec<Vec<f64>>,
    /// How each load was applied.
    pub followed: Vec<Followed>,
    seconds: Vec<f64>,
    /// The work of each load, J; see [`Case::work`].
    works: Vec<Option<f64>>,
    /// The name of each load, and the displacements on the way to it.
    paths: Vec<(String, Vec<Vec<f64>>)>,
}

impl LargeBody {
    /// A body without loads.
    pub fn at_rest(laws: impl Into<EnergyMap>) -> LargeBody {
        let laws = laws.into();
        let (newton, displacements, followed, seconds, works, paths) = Default::default();
        LargeBody { laws, newton, displacements, followed, seconds, works, paths }
    }

    /// Solves every load.
    ///
    /// # Errors
    /// The cells do not fill their space, or the equations do not fit into memory. A load that is not reached is not an
    /// error.
    pub fn solve(
        mesh: &Mesh,
        laws: EnergyMap,
        newton: Newton,
        cases: &[Case],
        progress: &mut Progress,
    ) -> Result<LargeBody> {
        check_embedded(mesh, &laws)?;
        if !cases.is_empty() {
            check_body(mesh)?;
        }
        let mut body = LargeBody { newton, ..LargeBody::at_rest(laws) };
        for (done, case) in cases.iter().enumerate() {
            progress(Event::stage("finite elements", done, cases.len()));
            let start = Clock::start();
            let model = Body::new(mesh, &body.laws);
            let found = reach(&newton, &model, mesh, case)?;
            body.seconds.push(start.seconds());
            body.followed.push(Followed::of(&found, &model));
            body.works.push(work(case, &model, &mesh.points, &found.displacement));
            body.displacements.push(found.displacement);
            body.paths.push((case.name.clone(), found.path));
        }
        progress(Event::stage("finite elements", cases.len(), cases.len()));
        Ok(body)
    }

    /// The displacements of each load, or `None` if it was not reached.
    pub fn complete(&self) -> impl Iterator<Item = Option<&Vec<f64>>> {
        let reached = |(u, f): (_, &Followed)| (f.ending == Ending::Converged).then_some(u);
        self.displacements.iter().zip(&self.followed).map(reached)
    }

    /// The positions of all points on the way to these loads.
    ///
    /// # Errors
    /// No part of any of them was reached.
    pub fn states(&self, mesh: &Mesh, loads: &[String]) -> Result<Vec<Vec<f64>>> {
        let named = self.paths.iter().filter(|(name, _)| loads.contains(name));
        let states: Vec<Vec<f64>> = named.flat_map(|(_, path)| path).map(|u| displaced(&mesh.points, u)).collect();
        if states.is_empty() && !loads.is_empty() {
            let expected = "loads that the finite elements reach in part at least";
            return Err(Error::expected("loads", expected, format!("none of {}", loads.join(", "))));
        }
        Ok(states)
    }

    /// Solves every load with the network.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn compare(&self, mesh: &Mesh, cases: &[Case], network: &Network) -> Result<Vec<LoadOutcome>> {
        if !cases.is_empty() {
            network.check_size()?;
        }
        let mut loads = Vec::new();
        for (i, case) in cases.iter().enumerate() {
            let start = Clock::start();
            let model: &dyn Elastic = network;
            let found = reach(&self.newton, model, mesh, case)?;
            let seconds_lem = start.seconds();
            let followed = Followed::of(&found, &Body::new(mesh, &self.laws));
            let complete = |followed: &Followed| followed.ending == Ending::Converged;
            let displacement = complete(&followed).then_some(found.displacement);
            // Displacements of a load that the body has not reached are those of a smaller load, and no measure of the
            // network.
            let known = case.measured.is_some() || complete(&self.followed[i]);
            let compared = displacement.as_ref().filter(|_| known);
            let own = compared.and_then(|u| work(case, model, &mesh.points, u));
            loads.push(LoadOutcome {
                name: case.name.clone(),
                error: compared.and_then(|u| case.error(mesh, &self.displacements[i], u)),
                largest_displacement: displacement.as_ref().and_then(|u| finite(mesh.largest_motion(u))),
                work_error: case.work_error(self.works[i], own),
                displacement: displacement.map(Arc::new),
                seconds_fem: self.seconds[i],
                seconds_lem,
                followed: Some(followed),
                ..LoadOutcome::default()
            });
        }
        Ok(loads)
    }
}

impl LargeBody {
    /// The processor time in which Newton's method follows a load with this model, s; `None` if the load is not reached.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn seconds(&self, model: &dyn Elastic, mesh: &Mesh, case: &Case) -> Result<Option<f64>> {
        let start = Clock::start();
        let found = reach(&self.newton, model, mesh, case)?;
        Ok((found.ending == Ending::Converged).then(|| start.seconds()))
    }
}

/// That a law serves the cells, among them those of surfaces and curves in space.
///
/// # Errors
/// One has condensed functions, is bent at rest, or its law has fibres.
pub(super) fn check_embedded(mesh: &Mesh, laws: &EnergyMap) -> Result<()> {
    let unsupported = |expected: &str, found: String| {
        Err(Error::expected("material.law", expected, found).of_kind(ErrorKind::Unsupported))
    };
    mesh.blocks.iter().try_for_each(|block| block.element.check_plain("large deformation"))?;
    if let Some((cell, bend)) = Body::new(mesh, laws).bent() {
        let name = &mesh.blocks[cell.block].element.name;
        let found = format!("{name} cell {} that is bent by {bend:.1e} of its size", cell.cell + 1);
        return unsupported("flat cells of surfaces in space; triangles of three nodes always are", found);
    }
    let is_embedded = |cell: &CellIndex| mesh.blocks[cell.block].element.dimension() < mesh.dimension;
    let mut cells = mesh.cell_indices().filter(is_embedded).map(|cell| laws.at(cell.block, cell.cell).0);
    match cells.find(|law| law.has_fibres()) {
        Some(law) => unsupported("a law without fibres on surfaces and curves in space", format!("\"{}\"", law.name())),
        None => Ok(()),
    }
}

/// The equilibrium of a model under a load, or the last one on the way to it.
pub(super) fn reach(newton: &Newton, model: &dyn Elastic, mesh: &Mesh, case: &Case) -> Result<Equilibrium> {
    if let Some(cavity) = &case.cavity {
        return newton.fill(model, &mesh.points, &case.support, cavity);
    }
    let pattern = pattern(model, mesh, case)?;
    newton.solve_with(model, &mesh.points, &case.support, case.applied(), pattern.as_ref())
}

/// The equations of all steps of a load, without values; `None` if the model has no tangent at rest.
fn pattern(model: &dyn Elastic, mesh: &Mesh, case: &Case) -> Result<Option<System>> {
    let Some(rest) = model.respond(&mesh.points) else { return Ok(None) };
    let pattern = Newton::pattern_under(&rest.tangent, &case.support, &mesh.points, case.applied())?;
    Ok(Some(pattern.placed(&mesh.points, mesh.dimension)))
}

pub(super) fn work(case: &Case, model: &dyn Elastic, points: &[f64], u: &[f64]) -> Option<f64> {
    // The work of forces that follow is by where they are at the end.
    if case.pressed.is_some() {
        return Some(product(&case.applied().at(points, u), u)).filter(|work| work.is_finite());
    }
    case.work(u, || {
        let mut force = vec![0.0; u.len()];
        model.forces(&displaced(points, u), &mut force).then(|| product(&force, u))
    })
}

/// The largest pressure, if another one came after it.
fn passed(pressures: &[f64]) -> Option<f64> {
    let largest = pressures.iter().copied().reduce(f64::max)?;
    // A pressure that falls while the volume grows has passed a maximum.
    pressures.last().is_some_and(|last| *last < largest).then_some(largest)
}

impl Followed {
    /// `body` has the cells that may be inverted.
    fn of(found: &Equilibrium, body: &Body) -> Followed {
        Followed {
            ending: found.ending,
            load: found.load,
            residual: found.residuals.last().and_then(|r| r.last()).copied().unwrap_or(f64::NAN),
            iterations: found.residuals.iter().map(Vec::len).sum(),
            shifted: found.shifted,
            is_rounded: found.is_rounded,
            inverted: body.inverted(&displaced(&body.mesh.points, &found.displacement)),
            pressure: found.pressures.last().copied(),
            pressure_passed: passed(&found.pressures),
        }
    }
}
