//! What the fits of a scene cost.

use super::costs::FitTimes;
use super::repeats::{TimedWork, Times, interleaved};
use crate::analysis::tensor::network_material;
use crate::clock::Clock;
use crate::error::Result;
use crate::fits::{Fitted, NamedFit, Reference, Task};
use crate::fitting::matrix_errors;
use crate::material::MaterialMap;
use crate::mesh::Mesh;

/// The costs of each fit of the body, in turns with the others, on the calling thread alone.
///
/// # Errors
/// A fit does not go with the mesh or the material.
pub fn time_fits(
    mesh: &Mesh,
    material: &MaterialMap,
    reference: &Reference,
    fits: &[NamedFit],
) -> Result<Vec<FitTimes>> {
    let make = |fit: &NamedFit| {
        let task = Task { name: &fit.name, springs: fit.springs.as_deref(), mesh, material, reference };
        fit.recipe.kind().fit(&task, &mut |_| {})
    };
    let mut assembly: Vec<Vec<f64>> = vec![Vec::new(); fits.len()];
    // The springs of the last pass are those that errors and moduli are timed with.
    let mut last: Vec<Option<Fitted>> = fits.iter().map(|_| None).collect();
    let mut works: Vec<TimedWork> = Vec::new();
    for ((fit, assembly), last) in fits.iter().zip(&mut assembly).zip(&mut last) {
        works.push(Box::new(move || {
            let fitted = last.insert(make(fit)?);
            assembly.push(fitted.seconds_assembly);
            Ok(fitted.seconds)
        }));
    }
    let constants = interleaved(&mut works)?;
    drop(works);
    let fitted: Vec<Fitted> = last.into_iter().flatten().collect();
    let mut works: Vec<TimedWork> = Vec::new();
    for fitted in &fitted {
        works.push(Box::new(move || {
            let clock = Clock::start();
            matrix_errors(mesh, material, fitted.of_elements())?;
            Ok(clock.seconds())
        }));
        works.push(Box::new(move || {
            let clock = Clock::start();
            network_material(mesh, material, fitted.owners(), &fitted.network);
            Ok(clock.seconds())
        }));
    }
    let after = interleaved(&mut works)?;
    let mut of = |(place, fitted): (usize, &Fitted)| FitTimes {
        constants: constants[place].clone(),
        element: constants[place].scaled(1.0 / fitted.fitted_elements(mesh) as f64),
        assembly: Times::of(std::mem::take(&mut assembly[place])),
        errors: (!fitted.of_elements().is_empty()).then(|| after[2 * place].clone()),
        moduli: after[2 * place + 1].clone(),
    };
    Ok(fitted.iter().enumerate().map(&mut of).collect())
}
