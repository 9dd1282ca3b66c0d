//! Calibrates the body of a scene.

use super::meshes::{level, meshes};
use super::notes::MANY;
use super::outcome::{CalibratedLoad, CalibrationOutcome, MeshStep};
use super::readings::{Observed, Readings};
use super::regions::{Spread, regions};
use crate::analysis::statistics::beyond;
use crate::calibration::{Asked, Estimate, FieldEstimate, Laws, Limit, Unknown, Unknowns, estimate, estimate_field};
use crate::clock::Clock;
use crate::error::{Error, ErrorKind, Result};
use crate::material::MaterialMap;
use crate::mesh::{CellBlock, Mesh};
use crate::named::unknown;
use crate::text::rounded;
use springfit_scenes::{CalibrationRecipe, Controls, Event, Progress, Scene, applied_cases};

/// Residuals that are as large by chance with a smaller probability are more than noise. One run in a hundred with
/// right noise is warned of.
const UNLIKELY: f64 = 0.01;
/// Displacements beyond this share of the body are often beyond the linear theory: a bar that is pulled so has the strain from which on a run tells of it.
const LARGE: f64 = 0.1;
/// What a field has for the error of meshes: one refinement, whose difference is extrapolated.
const OF_FIELD: usize = 1;

/// Finds the moduli of the body of a scene from its measurements, as its `[calibrate]` says.
///
/// # Errors
/// The scene has no measurements or wrong ones, a place is outside of the body, or a load has no equilibrium.
pub fn calibrate(scene: &Scene, progress: &mut Progress) -> Result<CalibrationOutcome> {
    calibrate_with(scene, None, &Readings::new(), &Controls::default(), progress)
}

/// Calibrates as [`calibrate`] does, with another mesh than that of the scene and measurements that the scene does not name.
///
/// # Errors
/// This returns the errors of [`calibrate`].
pub fn calibrate_with(
    scene: &Scene,
    mesh: Option<Mesh>,
    readings: &Readings,
    controls: &Controls,
    progress: &mut Progress,
) -> Result<CalibrationOutcome> {
    let start = Clock::start();
    let usual = CalibrationRecipe {
        asked: Asked::Young,
        known: Vec::new(),
        loads: None,
        prior: Default::default(),
        refinements: None,
    };
    let recipe = scene.calibration().unwrap_or(&usual);
    let mesh = match mesh {
        Some(mut mesh) => {
            scene.choose(&mut mesh);
            mesh
        }
        None => scene.build_mesh()?,
    };
    let is_plain =
        |block: &CellBlock| block.element.check_plain("calibrations, whose derivatives are linear in the moduli");
    mesh.blocks.iter().try_for_each(is_plain)?;
    let base = scene.material_of(&mesh)?;
    base.materials().map_err(|_| {
        let expected = "isotropic materials, where moduli are found";
        scene.placed(Error::expected("material", expected, "an anisotropic one").of_kind(ErrorKind::Unsupported))
    })?;
    if scene.law().is_some() && recipe.asked == Asked::Cells {
        let expected = "\"young\" or \"moduli\" of a material with a law";
        return Err(scene.at("calibrate", Error::expected("unknowns", expected, "\"cells\"")));
    }
    let is_known = known_regions(&scene.region_names(&base), recipe).map_err(|e| scene.at("calibrate", e))?;
    let (_, cases) = applied_cases(scene, &mesh, &base)?;
    let is_forced: Vec<bool> = cases.iter().map(|case| case.forces.iter().any(|force| *force != 0.0)).collect();
    let supports: Vec<_> = cases.into_iter().map(|case| case.support).collect();
    let mut observed = Observed::of(scene, &mesh, &supports, readings, recipe.loads.as_deref())?;
    let held = std::mem::take(&mut observed.held);
    let (weights, noise) = observed.weights()?;
    let has_forces = observed.has_forces() || observed.loads.iter().any(|load| is_forced[*load]);
    // With both moduli Poisson's ratio is seen, and Young's modulus is said not to be.
    if !has_forces && recipe.asked != Asked::Moduli && is_known.iter().all(|known| !known) {
        let expected = "loads of forces, or \"reactions\" that were measured, or a region that is \"known\": what is prescribed moves the body alike \
                        whatever factor all moduli have in common";
        return Err(scene.at("calibrate", Error::expected("unknowns", expected, "prescribed displacements alone")));
    }
    let (most, size) = (observed.largest(), mesh.longest_side());
    if most > size && scene.law().is_none() {
        let expected = format!(
            "displacements below the size of the body, {} m, which \"scale\" of \"measured\" gives the unit",
            rounded(size, 4)
        );
        return Err(scene.placed(Error::expected("measured", expected, format!("{} m", rounded(most, 4)))));
    }
    if recipe.asked == Asked::Cells && !noise {
        let expected = "the noise of all measurements, by which the prior of a field is weighed";
        return Err(scene.placed(Error::expected("sigma", expected, "none")));
    }
    let laws = |mesh: &Mesh, materials: &MaterialMap| {
        let none = || Error::expected("material.law", "a law", "none");
        scene.laws(mesh, materials)?.ok_or_else(none)
    };
    let laws: Option<&Laws> = scene.law().map(|_| &laws as &Laws);
    let cells = mesh.cell_count();
    let wanted = recipe.refinements.or((recipe.asked == Asked::Cells).then_some(OF_FIELD));
    let mut levels = Vec::new();
    let mut first: Option<Mesh> = None;
    for mesh in meshes(scene, mesh, wanted)? {
        levels.push(level(scene, mesh.clone(), (recipe.asked, first.as_ref()), &observed, laws)?);
        first = first.or(Some(mesh));
    }
    let unknowns = Unknowns::new(recipe.asked, &is_known, cells);
    let limit = Limit { levels, unknowns, observations: observed.observations, weights };
    let mut goes_on = |steps: usize| {
        // How many steps there will be is not known.
        progress(Event::stage("calibrate", steps, 0));
        !controls.cancelled()
    };
    let mut outcome = match recipe.asked {
        Asked::Cells => {
            let found = estimate_field(&limit, recipe.prior, &mut goes_on)?;
            of_field(&limit, &base, found)
        }
        Asked::Young | Asked::Moduli => {
            let found = estimate(&limit, noise, &mut goes_on)?;
            of_regions(&limit, &base, (&scene.region_names(&base), &is_known), noise, found)
        }
    };
    count_held(&mut outcome, &limit, &held);
    outcome.scene = scene.title().into();
    outcome.unknowns = recipe.asked.name().into();
    outcome.seconds = start.seconds();
    outcome.is_trusted = outcome.stands();
    outcome.notes = outcome.sentences();
    if most > LARGE * size && scene.law().is_none() {
        outcome.notes.push(format!(
            "displacements of up to {:.0} % of the body are measured, and moduli are those of the linear theory, which may not hold there: law = \
             \"stable-neo-hookean\" in [material] finds them at large deformation",
            100.0 * most / size
        ));
    }
    Ok(outcome)
}

/// Whether each region keeps its moduli.
fn known_regions(names: &[String], recipe: &CalibrationRecipe) -> Result<Vec<bool>> {
    let names = || names.iter().map(String::as_str);
    for name in &recipe.known {
        if names().all(|known| known != name) {
            let expected = format!("entries of [[material]] ({})", names().collect::<Vec<_>>().join(", "));
            return Err(unknown(expected, names(), name).at_key("known"));
        }
    }
    let is_known: Vec<bool> = names().map(|name| recipe.known.iter().any(|known| known == name)).collect();
    if is_known.iter().all(|known| *known) {
        return Err(Error::expected("known", "a region whose moduli are not known", "all of them"));
    }
    Ok(is_known)
}

fn of_field(limit: &Limit, base: &MaterialMap, found: FieldEstimate) -> CalibrationOutcome {
    let mut young = Vec::new();
    for (block, cells) in limit.levels[0].mesh.blocks.iter().enumerate() {
        for cell in 0..cells.cells().len() {
            let guess = base.isotropic(block, cell).map_or(f64::NAN, |material| material.young());
            young.push(guess * found.theta[young.len()].exp());
        }
    }
    let mut outcome = empty(limit, &found.residuals, true);
    outcome.misfit = Some(found.misfit);
    outcome.chi_square = Some(found.residuals.iter().map(|r| r * r).sum());
    outcome.degrees_of_freedom = None;
    outcome.young_by_cell = young;
    outcome.deviation_by_cell = found.deviations;
    outcome.prior_weight = Some(found.weight);
    outcome.steps = found.steps;
    outcome.is_unfinished = !found.is_within_noise;
    outcome
}

fn of_regions(
    limit: &Limit,
    base: &MaterialMap,
    (names, is_known): (&[String], &[bool]),
    noise: bool,
    found: Estimate,
) -> CalibrationOutcome {
    // Each unknown that is fitted takes one degree of freedom from the residuals.
    let freedom = found.residuals.len() - limit.unknowns.count();
    let square: f64 = found.residuals.iter().map(|r| r * r).sum();
    // What is left of the error of the meshes is no fault of the model.
    let probability = noise.then(|| chi_squared_beyond((square - found.left).max(0.0), freedom));
    let is_unexplained = probability.is_some_and(|probability| probability < UNLIKELY);
    // The probability above leaves out what the meshes cause, which may be nearly all of the residuals.
    let is_far = noise && found.misfit > MANY;
    let excess = if is_unexplained || is_far { found.misfit.max(1.0) } else { 1.0 };
    let region = |region: usize| &names[region];
    let name = |unknown: &Unknown| match unknown {
        Unknown::Young(r) => format!("E of {}", region(*r)),
        Unknown::Poisson(r) => format!("nu of {}", region(*r)),
        Unknown::Cell(cell) => format!("E of cell {}", cell + 1),
    };
    let unknowns: Vec<String> = limit.unknowns.all.iter().map(name).collect();
    let correlation = |p: usize, q: usize| {
        let covariance = found.covariance[p][q]?;
        let sizes = found.covariance[p][p]? * found.covariance[q][q]?;
        // Rounding can take the quotient of unknowns that are seen together alone beyond one.
        (sizes > 0.0).then(|| (covariance / sizes.sqrt()).clamp(-1.0, 1.0))
    };
    let all = 0..unknowns.len();
    let mut weak: Vec<String> =
        found.weak.iter().map(|own| own.iter().map(|p| unknowns[*p].clone()).collect::<Vec<_>>().join(", ")).collect();
    let mut seen = std::collections::HashSet::new();
    weak.retain(|words| seen.insert(words.clone()));
    let mut outcome = empty(limit, &found.residuals, noise);
    outcome.regions = regions(base, (names, is_known), &limit.unknowns, &Spread { estimate: &found, excess });
    outcome.correlations = all.clone().map(|p| all.clone().map(|q| correlation(p, q)).collect()).collect();
    outcome.names = unknowns;
    outcome.hardly_seen = weak;
    outcome.chi_square = noise.then_some(square);
    outcome.degrees_of_freedom = Some(freedom);
    outcome.misfit = noise.then_some(found.misfit);
    outcome.probability = probability;
    outcome.is_unexplained = is_unexplained;
    outcome.by_noise_alone = found.mesh.is_none();
    outcome.ratio = found.ratio;
    for (step, changes) in outcome.meshes.iter_mut().zip(&found.changes) {
        step.changes = changes.clone();
    }
    outcome.steps = found.steps;
    outcome.is_unfinished = found.fault.is_some();
    outcome
}

/// What all calibrations have.
fn empty(limit: &Limit, residuals: &[f64], noise: bool) -> CalibrationOutcome {
    let meshes = limit.levels.iter().map(|level| MeshStep {
        cells: level.mesh.cell_count(),
        unknowns: level.mesh.points.len(),
        changes: Vec::new(),
    });
    CalibrationOutcome {
        loads: loads(limit, residuals, noise),
        measurements: residuals.len(),
        explained: explained(limit, residuals),
        is_trusted: true,
        by_noise_alone: true,
        meshes: meshes.collect(),
        ..CalibrationOutcome::default()
    }
}

fn loads(limit: &Limit, residuals: &[f64], noise: bool) -> Vec<CalibratedLoad> {
    let mut all = Vec::new();
    for (index, load) in limit.levels[0].loads.iter().enumerate() {
        for force in [false, true] {
            let own: Vec<usize> = (0..residuals.len())
                .filter(|&i| limit.observations[i].load == index && limit.observations[i].quantity.is_force() == force)
                .collect();
            if own.is_empty() {
                continue;
            }
            let rms =
                |of: &dyn Fn(usize) -> f64| (own.iter().map(|&i| of(i).powi(2)).sum::<f64>() / own.len() as f64).sqrt();
            all.push(CalibratedLoad {
                load: load.name.clone(),
                quantity: if force { "forces" } else { "displacements" }.into(),
                measurements: own.len(),
                size: rms(&|i| limit.observations[i].value),
                // Residuals carry their weights, which are taken off here to give metres or newtons.
                residual: rms(&|i| residuals[i] / limit.weights[i]),
                sigma: noise.then(|| rms(&|i| 1.0 / limit.weights[i])),
                misfit: noise.then(|| rms(&|i| residuals[i])),
                held: 0,
                held_residual: None,
            });
        }
    }
    all
}

/// The share of the squares of what was measured that is not in the residuals.
fn explained(limit: &Limit, residuals: &[f64]) -> f64 {
    let all = limit.observations.iter().zip(&limit.weights);
    let square: f64 = all.map(|(seen, weight)| (weight * seen.value).powi(2)).sum();
    // All that was measured may be zero where sigma is given: the quotient is then infinite or zero, and never NaN.
    1.0 - residuals.iter().map(|r| r * r).sum::<f64>() / square.max(f64::MIN_POSITIVE)
}

/// Tells each load how far what is held was measured to be from where it is.
fn count_held(outcome: &mut CalibrationOutcome, limit: &Limit, held: &[(usize, f64)]) {
    for (index, load) in limit.levels[0].loads.iter().enumerate() {
        let own: Vec<f64> =
            held.iter().filter(|(load, _)| *load == index).map(|(_, distance)| distance.abs()).collect();
        if let Some(record) = outcome.loads.iter_mut().find(|record| record.load == load.name && !own.is_empty()) {
            record.held = own.len();
            record.held_residual = own.into_iter().reduce(f64::max);
        }
    }
}

/// The probability that a number with the χ² distribution of `freedom` degrees of freedom exceeds `square` (Wilson and Hilferty 1931).
fn chi_squared_beyond(square: f64, freedom: usize) -> f64 {
    // Where measurements are no more than unknowns nothing is left to divide by.
    let k = freedom.max(1) as f64;
    // The cube root of χ²/k is nearly normal, with the mean 1 − 2/(9k) and the variance 2/(9k).
    let share = 2.0 / (9.0 * k);
    beyond(((square / k).cbrt() - (1.0 - share)) / share.sqrt())
}
