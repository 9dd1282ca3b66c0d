//! The errors of a whole-object fit under loads that it has not seen, beside those of finite elements with the same mesh.

use super::body::WholeBody;
use super::outcome::{HeldOut, ModelError};
use super::recipe::WholeRecipe;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::model::{Network, Support};
use crate::solve::Equations;
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
        let supports = self.all_supports(recipe)?;
        let mut all = Vec::new();
        for (held, is_trained) in supports {
            let seed = recipe.seed.wrapping_add(SEED);
            let make = |mesh: &Mesh, support: &Support| varied_loads(mesh, support, thickness, LOADS, seed);
            let targets = self.made("loads", &held, (&make, seed), progress)?;
            let models = [
                ("finite elements", Some(self.equations("supports", &held.support)?)),
                ("start", self.equations_of(start, &held.support)?),
                ("fitted", self.equations_of(fitted, &held.support)?),
            ];
            let models = models.into_iter().map(|(model, equations)| model_error(model, equations, &targets));
            let models = models.collect::<Result<_>>()?;
            let seconds_fine = match (self.fine, &held.fine) {
                (Some(fine), Some(support)) => Some(fine.seconds_per_step(support)?),
                _ => None,
            };
            all.push(HeldOut { support: held.words(), is_trained, loads: targets.len(), models, seconds_fine });
        }
        Ok(all)
    }
}

fn model_error(model: &'static str, equations: Option<Equations>, targets: &[Target]) -> Result<ModelError> {
    let mut none = ModelError { model, median: None, worst: None, worst_load: None, seconds_per_step: None };
    let Some(equations) = equations else { return Ok(none) };
    none.seconds_per_step = Some(equations.seconds_per_step()?);
    let square = |u: &[f64]| u.iter().map(|u| u * u).sum::<f64>();
    let forces: Vec<Vec<f64>> = targets.iter().map(|target| target.forces.clone()).collect();
    let found = equations.solve_all(&forces)?;
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
    let (median, worst, worst_load) = (Some((low + high) / 2.0), Some(*worst), Some((*load).into()));
    Ok(ModelError { median, worst, worst_load, ..none })
}
