//! The processor time of a solution at small deformation, from the model to its displacements.

use super::case::Case;
use crate::clock::Clock;
use crate::error::Result;
use crate::material::{CellMap, Hooke};
use crate::mesh::Mesh;
use crate::model::{BlockStiffness, Network};
use crate::solve::{Equations, KnownPatterns, StaticSolver};

/// Returns the processor time of a solution with finite elements, s, or `None` if some motion has no stiffness.
///
/// # Errors
/// The equations do not fit into memory.
pub fn seconds_of_body(mesh: &Mesh, moduli: &CellMap<Hooke>, case: &Case, solver: StaticSolver) -> Result<Option<f64>> {
    let start = Clock::start();
    let equations = Equations::of_body(mesh, moduli, &case.support, (solver, 1), &KnownPatterns::default())?;
    finished(equations, case, start)
}

/// Returns the processor time of a solution with a network, s, or `None` if the network is not stable.
///
/// # Errors
/// The equations do not fit into memory.
pub fn seconds_of_network(mesh: &Mesh, network: &Network, case: &Case, solver: StaticSolver) -> Result<Option<f64>> {
    let (points, support) = (&mesh.points, &case.support);
    let start = Clock::start();
    let equations = match solver.iterates(mesh, 1) {
        true => Equations::iterated(BlockStiffness::of_network(network, points, None), points, support, solver)?,
        false => Equations::factored(&network.stiffness(points), support, points, mesh.dimension)?,
    };
    finished(equations, case, start)
}

fn finished(equations: Option<Equations>, case: &Case, start: Clock) -> Result<Option<f64>> {
    let Some(equations) = equations else { return Ok(None) };
    let (u, _) = equations.solve(&case.forces)?;
    Ok(u.iter().all(|u| u.is_finite()).then(|| start.seconds()))
}
