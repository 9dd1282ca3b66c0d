//! The loads of a scene at small deformation on a finer mesh of its body.

use super::case::Case;
use super::linear_answers::{check_residual, largest_residual, not_definite};
use crate::analysis::metrics::square;
use crate::error::Result;
use crate::material::{CellMap, Hooke, MaterialMap};
use crate::mesh::Mesh;
use crate::model::{Support, finite_elements};
use crate::progress::{Event, Progress};
use crate::solve::{Equations, KnownEquations, KnownPatterns, StaticSolver};

/// The answer of the finite elements of a finer mesh to one load.
pub struct FinerAnswer {
    /// `[points · dimension]`, m.
    pub displacement: Vec<f64>,
    /// J; see [`Case::work`].
    pub work: Option<f64>,
}

/// The equations of the finite elements under a support, for about `loads` loads.
///
/// # Errors
/// Some motion has no stiffness, or the equations do not fit into memory.
pub(super) fn equations(
    mesh: &Mesh,
    moduli: &CellMap<Hooke>,
    support: &Support,
    (solver, loads): (StaticSolver, usize),
) -> Result<Equations> {
    Equations::of_body(mesh, moduli, support, (solver, loads), &KnownPatterns::default())?
        .ok_or_else(|| not_definite(mesh))
}

/// The answers to all loads; equations are kept in `known`, and `stage` names the work.
///
/// # Errors
/// Those of [`equations`]; or more of the forces is left than an answer may leave.
pub(super) fn answers(
    (mesh, material, solver): (&Mesh, &MaterialMap, StaticSolver),
    cases: &[Case],
    known: &KnownEquations,
    stage: &str,
    progress: &mut Progress,
) -> Result<Vec<FinerAnswer>> {
    let moduli = material.moduli();
    let entries = cases.iter().any(|case| case.is_prescribed).then(|| finite_elements(mesh, &moduli));
    let mut found = Vec::with_capacity(cases.len());
    for (done, case) in cases.iter().enumerate() {
        progress(Event::stage(stage, done, cases.len()));
        let solve = || equations(mesh, &moduli, &case.support, (solver, cases.len()));
        let (displacement, residual) = known.under(&case.support, solve)?.solve(&case.forces)?;
        check_residual(residual, largest_residual(&solver), &case.name)?;
        let work = case.work(&displacement, || entries.as_ref().map(|entries| square(entries, &displacement)));
        found.push(FinerAnswer { displacement, work });
    }
    Ok(found)
}
