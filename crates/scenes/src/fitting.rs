//! Runs the fit of one recipe on a body.

use super::fits::{NamedFit, Reference, Task};
use super::outcome::{FitOutcome, MatrixErrors};
use super::progress::Progress;
use crate::analysis::tensor::network_material;
use crate::error::{Error, Result};
use crate::fit::{CellFits, SpreadSum, each_element_errors};
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use std::sync::OnceLock;

/// Fits one recipe on every cell, assembles the network, and computes the errors of the matrices; `reference` is required by sampled and
/// whole-object fits.
///
/// # Errors
/// The elements have no such spring group, a law does not belong to the groups, or there is nothing to sample.
pub fn fit_mesh(
    mesh: &Mesh,
    material: impl Into<MaterialMap>,
    reference: &Reference,
    named: &NamedFit,
    progress: &mut Progress,
) -> Result<FitOutcome> {
    let material = &material.into();
    let (outcome, cells) = fit_without_errors(mesh, material, reference, named, progress)?;
    let errors = matrix_errors(mesh, material, &cells)?;
    Ok(FitOutcome { errors: OnceLock::from(errors), ..outcome })
}

/// [`fit_mesh`] without the errors of the matrices, on which nothing else depends. Also the springs of each block of cells, from which
/// [`matrix_errors`] finds them; none where springs belong to no element.
///
/// # Errors
/// As [`fit_mesh`].
pub fn fit_without_errors(
    mesh: &Mesh,
    material: &MaterialMap,
    reference: &Reference,
    named: &NamedFit,
    progress: &mut Progress,
) -> Result<(FitOutcome, Vec<CellFits>)> {
    let task = Task { name: &named.name, springs: named.springs.as_deref(), mesh, material, reference };
    let mut fitted = named.recipe.kind().fit(&task, progress)?;
    if mesh.directors.is_some() {
        let bending = named.bending.unwrap_or_default();
        bending.check(mesh)?;
        let sheet = bending.of(mesh, &material.moduli());
        // Fits know the membrane; the springs that bend belong to no fit and are the same for all.
        fitted.network = std::mem::take(&mut fitted.network).joined(sheet);
    }
    let missing = || Error::at("engine", "belongs to a scene with supports");
    let in_engine =
        |setting| reference.whole.ok_or_else(missing)?.in_engine((&named.name, setting), &mut fitted, progress);
    let engine = named.engine.map(in_engine).transpose()?;
    let as_material = network_material(mesh, material, fitted.owners(), &fitted.network);
    let outcome = FitOutcome {
        fit: named.clone(),
        seconds: fitted.seconds,
        seconds_assembly: fitted.seconds_assembly,
        deficient: fitted.cells.iter().map(|cells| cells.deficient).sum(),
        unreached: fitted.cells.iter().map(|cells| cells.unreached).sum(),
        reused: fitted.cells.iter().map(|cells| cells.reused).sum(),
        times: None,
        model_times: None,
        errors: OnceLock::new(),
        unbalanced: OnceLock::new(),
        springs: fitted.springs,
        network: fitted.network,
        as_material,
        moduli: None,
        stability: None,
        loose_points: Vec::new(),
        loads: Vec::new(),
        engine,
        kind: fitted.kind,
    };
    let is_of_cells = outcome.kind.is_of_cells();
    Ok((outcome, if is_of_cells { fitted.cells } else { Vec::new() }))
}

/// The errors of the matrices of all cells, of which `cells` are the springs, block after block.
///
/// # Errors
/// The springs are not those of the mesh.
pub fn matrix_errors(mesh: &Mesh, material: &MaterialMap, cells: &[CellFits]) -> Result<MatrixErrors> {
    if cells.is_empty() {
        return Ok(MatrixErrors::default());
    }
    let (mut frobenius, mut spectral) = (SpreadSum::default(), SpreadSum::default());
    let moduli = material.moduli();
    for (index, (block, fit)) in mesh.blocks.iter().zip(cells).enumerate() {
        let moduli = moduli.block(index);
        each_element_errors(&block.element, &mesh.points, &block.connectivity, moduli, fit, &mut |errors| {
            frobenius.add(&errors.frobenius);
            spectral.add(&errors.spectral);
        })?;
    }
    Ok(MatrixErrors { frobenius: Some(frobenius.spread()), spectral: Some(spectral.spread()) })
}
