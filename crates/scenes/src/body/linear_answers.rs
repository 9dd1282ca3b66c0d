//! The answers of the solvers at small deformation to loads, whichever way they solve, and the residual that they may leave.

use super::case::Case;
use crate::analysis::metrics::SOLVED;
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::Mesh;
use crate::solve::{Solved, StaticSolver};

/// The answer of the finite elements to one load.
pub(super) struct BodyAnswer {
    pub displacement: Vec<f64>,
    /// J; see [`Case::work`].
    pub work: Option<f64>,
    pub seconds: f64,
    pub solved: Solved,
}

/// The answer of a network to one load.
pub(super) struct NetworkAnswer {
    pub displacement: Option<Vec<f64>>,
    /// J; see [`Case::work`].
    pub work: Option<f64>,
    pub seconds: f64,
    pub solved: Option<Solved>,
    /// Why there are no displacements, if they were sought.
    pub unsolved: Option<String>,
}

/// For each load the first load with the same support, whose equations it shares.
pub(super) fn shared(cases: &[Case]) -> Vec<usize> {
    let first = |case: &Case| cases.iter().position(|c| c.support == case.support).unwrap_or(0);
    cases.iter().map(first).collect()
}

/// The residual that iterations may leave, relative to the forces, in units of their tolerance. They end by the norm of the energy; the
/// residual of bodies with good cells was up to 3 of these units.
const LEFT: f64 = 10.0;

/// The largest residual of an answer by iterations, relative to the forces: never below what was asked of the solver.
pub(super) fn largest_residual(solver: &StaticSolver) -> f64 {
    SOLVED.max(LEFT * solver.tolerance)
}

/// # Errors
/// More of the forces is left than an answer may leave: kind `Limit`.
pub(super) fn check_residual(residual: f64, largest: f64, load: &str) -> Result<()> {
    if residual <= largest {
        return Ok(());
    }
    let expected = format!("equations that can be solved to {largest:.0e} of the forces");
    let found = format!("{residual:.1e} left under load \"{load}\"");
    let error = Error::expected("mesh", expected, found).of_kind(ErrorKind::Limit);
    // A limit above that of factors comes from the tolerance, which the user can change.
    Err(if largest > SOLVED { error.followed_by("; a smaller solver.tolerance leaves less") } else { error })
}

/// Makes the error of finite elements whose stiffness is not positive definite.
pub(super) fn not_definite(mesh: &Mesh) -> Error {
    let why = "the finite element stiffness is not positive definite: some motion has no stiffness";
    let bending = "; surfaces and curves resist no bending, so hold their points across them, or give triangles bending = \"plate\" in [material]";
    let mixed = "; the membranes and rods of the body resist no bending, so their points that no solid cell has are held across them";
    let hint = match (mesh.cell_dimension() < mesh.dimension, mesh.is_mixed()) {
        (true, _) => bending,
        (false, true) => mixed,
        (false, false) => "",
    };
    Error::at("mesh", format!("{why}{hint}")).of_kind(ErrorKind::Infeasible)
}
