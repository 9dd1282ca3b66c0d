//! The errors of a whole-object fit under loads that it has not seen, beside those of finite elements with the same mesh.

use super::body::WholeBody;
use super::held::Held;
use super::made_loads::MadeLoads;
use super::outcome::{HeldOut, ModelError, WorseLoad};
use super::recipe::WholeRecipe;
use crate::engine::{Setting, Truncated, TruncatedModel};
use crate::error::{ErrorKind, Result};
use crate::fit::{ShearSprings, VolumeSprings};
use crate::fits::exact::spring_words;
use crate::mesh::Mesh;
use crate::model::{Body, Elastic, Network, Support, exact_network};
use crate::number::finite;
use crate::progress::Progress;
use crate::solve::{Equations, Newton};
use crate::whole::{Pressure, Target, varied_loads};
use rayon::prelude::*;

/// The number of loads for each support.
// In the mean one further load in 31 is worse than the worst of thirty.
const LOADS: usize = 30;
/// Added to the seed of the recipe, so that the loads are others than those of the fit and of its validation.
const SEED: u64 = 1000;
/// Errors below this are those of rounding. A ratio of two of them would tell nothing.
const ROUNDING: f64 = 1e-6;
/// A load is worse than with the finite elements of the mesh if its error is this many times as large.
// It was chosen: with less, loads would be named of which either model may be the better one with another seed.
const WORSE: f64 = 1.1;
/// Springs that average the deformation over the cells around edges and nodes.
const SMOOTHED: (ShearSprings, VolumeSprings) = (ShearSprings::Edges, VolumeSprings::Patches);
/// The finite elements of the mesh.
const BODY: &str = "finite elements";
/// The model after the fit.
const FITTED: &str = "fitted";
/// The exact networks beside which a fit is compared.
const EXACT: [(ShearSprings, VolumeSprings); 3] =
    [(ShearSprings::Cells, VolumeSprings::Points), (ShearSprings::Cells, VolumeSprings::Patches), SMOOTHED];

/// A fit that leaves more than this share of the median error of smoothed springs gains nothing over them.
// It was chosen: smoothed springs need neither a finer body nor a fit, for which a tenth of an error is no reason.
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
        // Springs that are softer than the finite elements gain nothing where these are what errors are relative to.
        (smoothed > ROUNDING && median(BODY)? > ROUNDING).then_some(whole)
    }
}

impl WholeBody<'_> {
    /// The errors of the exact networks that the body has, and of the network at the start and after the fit, for each support of the fit
    /// and of its validation.
    pub(super) fn held_out(
        &self,
        (recipe, held): (&WholeRecipe, &[bool]),
        (start, fitted): (&Network, &Network),
        followed: &mut Option<MadeLoads>,
        progress: &mut Progress,
    ) -> Result<Vec<HeldOut>> {
        let thickness = &self.material.thicknesses();
        let supports = self.all_supports(recipe)?;
        let mut networks = self.exact_networks(held)?;
        networks.extend([("start".into(), start.clone()), (FITTED.into(), fitted.clone())]);
        let mut all = Vec::new();
        for (held, part) in supports {
            let seed = recipe.seed.wrapping_add(SEED);
            let make = |mesh: &Mesh, support: &Support, seed: u64| {
                varied_loads(mesh, support, thickness, Pressure::Varying, (LOADS, seed))
            };
            let targets = self.made(("loads", "held out"), &held, (&make, seed), followed, progress)?;
            let of_body = self.body_answers(&held, &targets)?;
            let mut models = vec![model_error(BODY, &of_body, &targets)];
            let mut worse = Vec::new();
            for (model, network) in &networks {
                // The exact networks are what equations that are solved to the end give.
                let engine = recipe.engine.filter(|_| ["start", FITTED].contains(&&model[..]));
                let answers = self.network_answers((network, engine), &held, &targets)?;
                models.push(model_error(model, &answers, &targets));
                // The fitted network is the last.
                worse = worse_loads(&targets, &of_body.errors, &answers.errors);
            }
            let seconds_fine = match (self.fine, &held.fine) {
                (Some(fine), Some(support)) => Some(fine.seconds_per_step(support)?),
                _ => None,
            };
            all.push(HeldOut { support: held.words(), part, loads: targets.len(), models, worse, seconds_fine });
        }
        Ok(all)
    }

    /// The answers of the finite elements of the mesh.
    fn body_answers(&self, held: &Held, targets: &[Target]) -> Result<ModelAnswers> {
        match (self.laws, self.newton) {
            (Some(laws), Some(newton)) => followed_answers(&newton, &Body::new(self.mesh, laws), self.mesh, targets),
            _ => linear_answers(&self.equations("supports", &held.support)?, targets),
        }
    }

    /// The answers of a network.
    fn network_answers(
        &self,
        (network, engine): (&Network, Option<Setting>),
        held: &Held,
        targets: &[Target],
    ) -> Result<ModelAnswers> {
        if let Some(setting) = engine {
            let model = TruncatedModel { network, points: &self.mesh.points, masses: self.engine_masses()? };
            let Some(truncated) = Truncated::new(model, &held.support, &setting)? else {
                return Ok(ModelAnswers::default());
            };
            let forces: Vec<Vec<f64>> = targets.iter().map(|target| target.forces.clone()).collect();
            let found = truncated.answers(&forces)?;
            let errors = targets.iter().zip(&found).map(|(target, u)| load_error(target, u)).collect();
            return Ok(ModelAnswers { errors, seconds: None });
        }
        if let Some(newton) = self.newton {
            return followed_answers(&newton, network, self.mesh, targets);
        }
        match self.equations_of(network, &held.support)? {
            Some(equations) => linear_answers(&equations, targets),
            None => Ok(ModelAnswers::default()),
        }
    }

    /// The exact networks that the body has, with their names.
    fn exact_networks(&self, held: &[bool]) -> Result<Vec<(String, Network)>> {
        let mut networks = Vec::new();
        // A body of other than isotropic materials has none.
        if self.material.materials().is_err() {
            return Ok(networks);
        }
        for (shear, volume) in EXACT {
            let network =
                self.exact(shear, volume).and_then(|fit| exact_network(self.mesh, &self.material, &fit, held));
            match network {
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

/// What a model answers to the loads.
#[derive(Default)]
struct ModelAnswers {
    /// `‖u − ū‖/‖ū‖` under each load, infinite without an equilibrium; none of a model that is not stable at rest.
    errors: Vec<f64>,
    seconds: Option<f64>,
}

/// `‖u − ū‖/‖ū‖`.
fn load_error(target: &Target, u: &[f64]) -> f64 {
    let square = |u: &[f64]| u.iter().map(|u| u * u).sum::<f64>();
    let difference: Vec<f64> = u.iter().zip(&target.displacement).map(|(a, b)| a - b).collect();
    (square(&difference) / square(&target.displacement)).sqrt()
}

fn linear_answers(equations: &Equations, targets: &[Target]) -> Result<ModelAnswers> {
    let forces: Vec<Vec<f64>> = targets.iter().map(|target| target.forces.clone()).collect();
    let found = equations.solve_all(&forces)?;
    let errors = targets.iter().zip(&found).map(|(target, u)| load_error(target, u)).collect();
    Ok(ModelAnswers { errors, seconds: Some(equations.seconds_per_step()?) })
}

/// The answers at large deformation. The displacements of a load are the first guess: the nearest equilibrium is that of the same branch.
fn followed_answers(
    newton: &Newton,
    model: &(dyn Elastic + Sync),
    mesh: &Mesh,
    targets: &[Target],
) -> Result<ModelAnswers> {
    let (Some(rest), Some(first)) = (model.respond(&mesh.points), targets.first()) else {
        return Ok(ModelAnswers::default());
    };
    let pattern = Newton::pattern(&rest.tangent, &first.support)?.placed(&mesh.points, mesh.dimension);
    let error = |target: &Target| {
        let Target { support, forces, displacement, .. } = target;
        let found = newton.reach_stable(model, &mesh.points, support, forces, Some(displacement), &pattern)?;
        Ok(found.map_or(f64::INFINITY, |(u, _)| load_error(target, &u)))
    };
    // Each load is followed on its own, and the list keeps its order: threads do not change the errors.
    Ok(ModelAnswers { errors: targets.par_iter().map(error).collect::<Result<_>>()?, seconds: None })
}

fn model_error(model: &str, answers: &ModelAnswers, targets: &[Target]) -> ModelError {
    let known = answers.errors.iter().zip(targets).map(|(error, target)| (*error, target.name.as_str()));
    // A load that moves nothing has the relative error 0/0.
    let mut errors: Vec<(f64, &str)> = known.filter(|(error, _)| !error.is_nan()).collect();
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    let lost = errors.iter().filter(|(error, _)| error.is_infinite()).count();
    // Of an even number the median is the mean of both errors in the middle, which are the same one of an odd number.
    let median = (!errors.is_empty()).then(|| (errors[(errors.len() - 1) / 2].0 + errors[errors.len() / 2].0) / 2.0);
    let worst = errors.last().copied();
    ModelError {
        model: model.into(),
        median: median.and_then(finite),
        worst: worst.and_then(|(worst, _)| finite(worst)),
        worst_load: worst.map(|(_, load)| load.into()),
        seconds_per_step: answers.seconds,
        lost,
    }
}

/// The loads whose errors are worse than those of the finite elements of the mesh.
fn worse_loads(targets: &[Target], of_body: &[f64], errors: &[f64]) -> Vec<WorseLoad> {
    let pairs = targets.iter().zip(of_body.iter().zip(errors));
    // JSON has no infinity: loads without an equilibrium are counted beside. Without a finer body the finite elements have no error, and each
    // load would be worse.
    let known = pairs.filter(|(_, (body, error))| **body > ROUNDING && body.is_finite() && error.is_finite());
    let worse = known.filter(|(_, (body, error))| **error > (WORSE * **body).max(ROUNDING));
    worse
        .map(|(target, (body, error))| WorseLoad { load: target.name.clone(), finite_elements: *body, fitted: *error })
        .collect()
}
