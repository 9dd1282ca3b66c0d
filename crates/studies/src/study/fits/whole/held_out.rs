//! The errors of a whole-object fit under loads that it has not seen, beside those of finite elements with the same mesh.

use super::body::WholeBody;
use super::outcome::{HeldOut, ModelError, WorseLoad};
use super::recipe::WholeRecipe;
use crate::error::{ErrorKind, Result};
use crate::fit::{ExactFit, ShearSprings, VolumeSprings};
use crate::mesh::Mesh;
use crate::model::{Network, Support, exact_network};
use crate::solve::Equations;
use crate::study::fits::exact::spring_words;
use crate::study::progress::Progress;
use crate::whole::{Pressure, Target, varied_loads};

/// The number of loads for each support.
const LOADS: usize = 30;
/// Added to the seed of the recipe, so that the loads are others than those of the fit and of its validation.
const SEED: u64 = 1000;
/// Errors below this are those of rounding.
const ROUNDING: f64 = 1e-6;
/// A load is worse than with the finite elements of the mesh if its error is this many times as large.
const WORSE: f64 = 1.1;
/// Springs that average the deformation over the cells around edges and nodes.
const SMOOTHED: (ShearSprings, VolumeSprings) = (ShearSprings::Edges, VolumeSprings::Patches);
/// The model after the fit.
const FITTED: &str = "fitted";
/// The exact networks beside which a fit is compared.
const EXACT: [(ShearSprings, VolumeSprings); 3] =
    [(ShearSprings::Cells, VolumeSprings::Points), (ShearSprings::Cells, VolumeSprings::Patches), SMOOTHED];

/// A fit that leaves more than this share of the median error of smoothed springs gains nothing over them.
const NO_GAIN: f64 = 0.9;

impl HeldOut {
    /// What the fit gains over smoothed springs, those on edges with patches, without a fit: networks of the same mesh that cost nothing. `None`
    /// where the body has none, or either has no error.
    pub(super) fn gain(&self) -> Option<String> {
        let (shear, volume) = SMOOTHED;
        let median = |name: &str| self.models.iter().find(|model| model.model == name)?.median;
        let (smoothed, fitted) = (median(&exact_name(shear, volume))?, median(FITTED)?);
        let share = fitted / smoothed;
        let words = if share > NO_GAIN { ": it gains nothing here" } else { "" };
        let whole = format!(
            "the fit leaves {share:.2} of the median error of springs on edges with patches without a fit{words}"
        );
        (smoothed > ROUNDING).then_some(whole)
    }
}

impl WholeBody<'_> {
    /// The errors of the exact networks that the body has, and of the network at the start and after the fit, for each support of the fit
    /// and of its validation.
    pub(super) fn held_out(
        &self,
        (recipe, held): (&WholeRecipe, &[bool]),
        start: &Network,
        fitted: &Network,
        progress: &mut Progress,
    ) -> Result<Vec<HeldOut>> {
        let thickness = &self.material.thicknesses();
        let supports = self.all_supports(recipe)?;
        let mut networks = self.exact_networks(held)?;
        networks.extend([("start".into(), start.clone()), (FITTED.into(), fitted.clone())]);
        let mut all = Vec::new();
        for (held, part) in supports {
            let seed = recipe.seed.wrapping_add(SEED);
            let make = |mesh: &Mesh, support: &Support| {
                varied_loads(mesh, support, thickness, Pressure::Varying, (LOADS, seed))
            };
            let targets = self.made("loads", &held, (&make, seed), progress)?;
            let body = self.equations("supports", &held.support)?;
            let of_body = load_errors(&body, &targets)?;
            let mut models = vec![model_error("finite elements", Some((&body, &of_body)), &targets)?];
            let mut worse = Vec::new();
            for (model, network) in &networks {
                let equations = self.equations_of(network, &held.support)?;
                let errors = equations.as_ref().map(|equations| load_errors(equations, &targets)).transpose()?;
                models.push(model_error(model, equations.as_ref().zip(errors.as_deref()), &targets)?);
                // The fitted network is the last.
                worse = worse_loads(&targets, &of_body, &errors.unwrap_or_default());
            }
            let seconds_fine = match (self.fine, &held.fine) {
                (Some(fine), Some(support)) => Some(fine.seconds_per_step(support)?),
                _ => None,
            };
            all.push(HeldOut { support: held.words(), part, loads: targets.len(), models, worse, seconds_fine });
        }
        Ok(all)
    }

    /// The exact networks that the body has at small deformation, with their names.
    fn exact_networks(&self, held: &[bool]) -> Result<Vec<(String, Network)>> {
        let mut networks = Vec::new();
        // A body of other than isotropic materials has none.
        if self.material.materials().is_err() {
            return Ok(networks);
        }
        for (shear, volume) in EXACT {
            let fit = ExactFit { shear, volume, ..ExactFit::default() };
            match exact_network(self.mesh, &self.material, &fit, held) {
                Ok(network) => networks.push((exact_name(shear, volume), network)),
                Err(error) if error.kind() == ErrorKind::Unsupported => {}
                Err(error) => return Err(error),
            }
        }
        Ok(networks)
    }
}

fn exact_name(shear: ShearSprings, volume: VolumeSprings) -> String {
    format!("exact{}", spring_words(shear, volume))
}

/// `‖u − ū‖/‖ū‖` under each load.
fn load_errors(equations: &Equations, targets: &[Target]) -> Result<Vec<f64>> {
    let square = |u: &[f64]| u.iter().map(|u| u * u).sum::<f64>();
    let forces: Vec<Vec<f64>> = targets.iter().map(|target| target.forces.clone()).collect();
    let error = |(target, u): (&Target, &Vec<f64>)| {
        let difference: Vec<f64> = u.iter().zip(&target.displacement).map(|(a, b)| a - b).collect();
        (square(&difference) / square(&target.displacement)).sqrt()
    };
    Ok(targets.iter().zip(&equations.solve_all(&forces)?).map(error).collect())
}

fn model_error(model: &str, found: Option<(&Equations, &[f64])>, targets: &[Target]) -> Result<ModelError> {
    let model = model.to_string();
    let mut none = ModelError { model, median: None, worst: None, worst_load: None, seconds_per_step: None };
    let Some((equations, errors)) = found else { return Ok(none) };
    none.seconds_per_step = Some(equations.seconds_per_step()?);
    let known = errors.iter().zip(targets).map(|(error, target)| (*error, target.name.as_str()));
    let mut errors: Vec<(f64, &str)> = known.filter(|(error, _)| error.is_finite()).collect();
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some((worst, load)) = errors.last() else { return Ok(none) };
    let (low, high) = (errors[(errors.len() - 1) / 2].0, errors[errors.len() / 2].0);
    let (median, worst, worst_load) = (Some((low + high) / 2.0), Some(*worst), Some((*load).into()));
    Ok(ModelError { median, worst, worst_load, ..none })
}

/// The loads whose errors are worse than those of the finite elements of the mesh.
fn worse_loads(targets: &[Target], of_body: &[f64], errors: &[f64]) -> Vec<WorseLoad> {
    let pairs = targets.iter().zip(of_body.iter().zip(errors));
    let worse = pairs.filter(|(_, (body, error))| **error > (WORSE * **body).max(ROUNDING));
    worse
        .map(|(target, (body, error))| WorseLoad { load: target.name.clone(), finite_elements: *body, fitted: *error })
        .collect()
}
