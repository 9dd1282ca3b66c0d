//! Runs the fit of one recipe on a body.

use super::fits::{NamedFit, Reference, Task};
use super::outcome::FitOutcome;
use super::progress::Progress;
use super::tensor::network_material;
use crate::error::Result;
use crate::fit::{SpreadSum, each_element_errors};
use crate::material::MaterialMap;
use crate::mesh::Mesh;

/// Fits one recipe on every cell and assembles the network; `reference` is required by sampled and whole-object fits.
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
    // Threads are started before the clock.
    rayon::broadcast(|_| ());
    let task = Task { name: &named.name, springs: named.springs.as_deref(), mesh, material, reference };
    let fitted = named.recipe.kind().fit(&task, progress)?;
    let (mut frobenius, mut spectral) = (SpreadSum::default(), SpreadSum::default());
    let of_cells = if fitted.kind.is_of_cells() { &fitted.cells[..] } else { &[] };
    let moduli = material.moduli();
    for (index, (block, fit)) in mesh.blocks.iter().zip(of_cells).enumerate() {
        let moduli = moduli.block(index);
        each_element_errors(&block.element, &mesh.points, &block.connectivity, moduli, fit, |errors| {
            frobenius.add(&errors.frobenius);
            spectral.add(&errors.spectral);
        })?;
    }
    let spread = |sum: SpreadSum| (!of_cells.is_empty()).then(|| sum.spread());
    let as_material = network_material(mesh, material, fitted.owners(), &fitted.network);
    Ok(FitOutcome {
        fit: named.clone(),
        seconds: fitted.seconds,
        seconds_assembly: fitted.seconds_assembly,
        deficient: fitted.cells.iter().map(|cells| cells.deficient).sum(),
        unreached: fitted.cells.iter().map(|cells| cells.unreached).sum(),
        reused: fitted.cells.iter().map(|cells| cells.reused).sum(),
        frobenius: spread(frobenius),
        spectral: spread(spectral),
        springs: fitted.springs,
        network: fitted.network,
        kind: fitted.kind,
        as_material,
        moduli: None,
        stability: None,
        loose_points: Vec::new(),
        loads: Vec::new(),
    })
}
