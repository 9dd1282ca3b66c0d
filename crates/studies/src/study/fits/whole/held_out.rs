//! The errors of a whole-object fit under loads that it has not seen, beside those of finite elements with the same mesh.

use super::body::WholeBody;
use super::outcome::{HeldOut, ModelError};
use super::recipe::WholeRecipe;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::model::{Entries, Network, Support, check_body};
use crate::solve::System;
use crate::study::progress::Progress;
use crate::whole::{Target, varied_loads};

/// The number of loads for each support.
const LOADS: usize = 30;
/// Added to the seed of the recipe, so that the loads are others than those of the fit and of its validation.
const SEED: u64 = 1000;

impl WholeBody<'_> {
    /// The errors of the network at the start and after the fit, for each support of the fit and of its validation.
    pub(super) fn held_out(
        &self,
        recipe: &WholeRecipe,
        start: &Network,
        fitted: &Network,
        progress: &mut Progress,
    ) -> Result<Vec<HeldOut>> {
        let thickness = &self.material.thicknesses();
        let mut supports: Vec<_> =
            self.supports("supports", &recipe.supports)?.into_iter().map(|held| (held, true)).collect();
        if !recipe.validation_supports.is_empty() {
            let others = self.supports("validate_supports", &recipe.validation_supports)?;
            supports.extend(others.into_iter().map(|held| (held, false)));
        }
        let points = &self.mesh.points;
        check_body(self.mesh)?;
        let models = [
            ("finite elements", self.entries().clone()),
            ("start", start.stiffness(points)),
            ("fitted", fitted.stiffness(points)),
        ];
        let mut all = Vec::new();
        for (held, is_trained) in supports {
            let seed = recipe.seed.wrapping_add(SEED);
            let make = |mesh: &Mesh, support: &Support| varied_loads(mesh, support, thickness, LOADS, seed);
            let targets = self.made("loads", &held, (&make, seed), progress)?;
            let models =
                models.iter().map(|(model, entries)| model_error(model, entries, &targets)).collect::<Result<_>>()?;
            all.push(HeldOut { support: held.words(), is_trained, loads: targets.len(), models });
        }
        Ok(all)
    }
}

fn model_error(model: &'static str, entries: &Entries, targets: &[Target]) -> Result<ModelError> {
    let none = ModelError { model, median: None, worst: None, worst_load: None };
    let Some(first) = targets.first() else { return Ok(none) };
    let system = System::new(entries, &first.support)?;
    let Some(factor) = system.cholesky()? else { return Ok(none) };
    let square = |u: &[f64]| u.iter().map(|u| u * u).sum::<f64>();
    let forces: Vec<Vec<f64>> = targets.iter().map(|target| target.forces.clone()).collect();
    let found = system.solve_all(&factor, &forces);
    let mut errors: Vec<(f64, &str)> = targets
        .iter()
        .zip(&found)
        .map(|(target, u)| {
            let difference: Vec<f64> = u.iter().zip(&target.displacement).map(|(a, b)| a - b).collect();
            ((square(&difference) / square(&target.displacement)).sqrt(), target.name.as_str())
        })
        .filter(|(error, _)| error.is_finite())
        .collect();
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some((worst, load)) = errors.last() else { return Ok(none) };
    let (low, high) = (errors[(errors.len() - 1) / 2].0, errors[errors.len() / 2].0);
    Ok(ModelError { model, median: Some((low + high) / 2.0), worst: Some(*worst), worst_load: Some((*load).into()) })
}
