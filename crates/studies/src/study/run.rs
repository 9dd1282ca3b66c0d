//! Runs a scene: fit each objective, solve each load with both models, compare.

use super::cases::{load_cases, measured_loads};
use super::checkpoint::Controls;
use super::course::Course;
use super::gauge::Gauged;
use super::large::LargeBody;
use super::linear::LinearBody;
use super::moduli::moduli_of_body;
use super::outcome::{FitOutcome, Outcome, SampledOutcome};
use super::scene::{NamedFit, Recipe, SampledRecipe, Scene};
use super::stages::stages;
use super::whole::WholeBody;
use crate::element::SpringKind;
use crate::error::{Error, Result};
use crate::fit::published::{self, Unmet};
use crate::fit::{ElementErrors, Objective, SampledFits, Spread, Weight, element_errors, fit_cells, fit_sampled};
use crate::material::{Energy, Material};
use crate::mesh::{CellBlock, Mesh};
use crate::model::{Network, masses};
use crate::springs::Springs;
use crate::whole::raise_idle;
use std::sync::Arc;
use std::time::Instant;

/// Told the stage, the steps done and the steps in all; with none in all, what is to be known at once.
pub type Progress<'a> = dyn FnMut(&str, usize, usize) + 'a;

/// Runs the scene. Work is done only for what the scene names.
///
/// # Errors
/// An input is wrong: a group, a support, a load, the mesh. A network that does not stand is no error.
pub fn run(scene: &Scene, progress: &mut Progress) -> Result<Outcome> {
    run_with(scene, &Controls::default(), progress)
}

/// As [`run`]; whole-object fits may be ended early and gone on with.
///
/// # Errors
/// As there, and the checkpoint is wrong or cannot be written.
pub fn run_with(scene: &Scene, controls: &Controls, progress: &mut Progress) -> Result<Outcome> {
    controls.check()?;
    let mesh = scene.build_mesh()?;
    let material = scene.material(mesh.cell_dimension())?;
    drawable(scene, &mesh)?;
    let (support, cases) = load_cases(scene, &mesh, material)?;
    let gauged = scene.gauge.as_ref().map(|gauge| Gauged::new(scene, gauge, &mesh, &cases)).transpose()?;
    let course = Course::plan(scene, &mesh, material, &support)?;
    let in_scene = |e: Error| e.placed(|e| e.in_file(&scene.path));
    let large = match scene.energy(material)? {
        Some(energy) => {
            let state = material.state();
            Some(LargeBody::solve(&mesh, state, energy, scene.newton, &cases, progress).map_err(in_scene)?)
        }
        None => None,
    };
    let masses = scene.density().map(|density| masses(&mesh, density, material.thickness()));
    let linear =
        |progress: &mut Progress| LinearBody::solve(&mesh, material.moduli(), &cases, progress).map_err(in_scene);
    // Of the fits only those to the whole object need the body's displacements.
    let needed = large.is_none() && scene.fits.iter().any(|fit| matches!(fit.recipe, Recipe::Whole(_)));
    let body = if needed { Some(linear(progress)?) } else { None };
    let mut whole = WholeBody::new(&mesh, material, &support, controls);
    whole.cases = &cases;
    whole.displacements = match (&large, &body) {
        (Some(large), _) => large.complete().collect(),
        (None, Some(body)) => body.displacements.iter().map(Some).collect(),
        (None, None) => Vec::new(),
    };
    whole.newton = large.as_ref().map(|_| scene.newton);
    whole.masses = masses.as_deref();
    whole.solved = body.as_ref().and_then(|body| body.held_by(&support, &cases));
    let reference = Reference { large: large.as_ref(), whole: Some(&whole) };
    let mut fits = Vec::new();
    for (fit, entry) in scene.fits.iter().zip(&scene.entry_of) {
        let fitted = fit_mesh(&mesh, material, &reference, fit, progress);
        fits.push(fitted.map_err(|e| e.placed(|e| scene.at(&format!("fit[{entry}]"), e)))?);
    }
    let count = fits.len();
    if scene.output.moduli {
        for (done, fit) in fits.iter_mut().enumerate() {
            progress("moduli", done, count);
            fit.moduli = moduli_of_body(&mesh, &fit.network.stiffness(&mesh.points))?;
        }
    }
    let law = large.as_ref().map(|large| large.energy.title.clone());
    let (fem, followed, energy) = match large {
        Some(large) => {
            for (done, fit) in fits.iter_mut().enumerate() {
                progress("networks", done, count);
                large.compare(&mesh, &cases, fit)?;
            }
            (large.displacements, large.followed, Some(large.energy))
        }
        None => {
            let body = body.map_or_else(|| linear(progress), Ok)?;
            for (done, fit) in fits.iter_mut().enumerate() {
                progress("networks", done, count);
                body.compare(&mesh, &cases, fit)?;
            }
            (body.displacements, Vec::new(), None)
        }
    };
    let mut outcome = Outcome {
        scene: scene.title.clone(),
        measured: measured_loads(&cases, &fem, mesh.dimension),
        left_out: stages(scene).into_iter().filter_map(|(what, why)| Some(format!("{what}: {}", why?))).collect(),
        mesh,
        material,
        masses,
        fem,
        law,
        followed,
        gauged: Vec::new(),
        fits,
        motion: None,
        frequencies: Vec::new(),
    };
    if let Some(gauged) = gauged {
        gauged.measure(&mut outcome);
    }
    if controls.cancelled() {
        progress("ended early: no motion, no frequencies", 0, 0);
    } else {
        course.follow(scene, energy.as_ref(), &mut outcome, progress)?;
    }
    Ok(outcome)
}

/// Asked for before the work, not after it.
fn drawable(scene: &Scene, mesh: &Mesh) -> Result<()> {
    match mesh.blocks.iter().find(|b| scene.output.vtu && b.element.formats.vtk.is_none()) {
        Some(block) => {
            let expected = "elements that name their VTK type in [formats]";
            Err(Error::expected("output.vtu", expected, &block.element.name).in_file(&scene.path))
        }
        None => Ok(()),
    }
}

/// What is known of the body that springs are fitted to, beyond its stiffness.
#[derive(Clone, Copy, Default)]
pub struct Reference<'a> {
    /// For sampled fits.
    pub large: Option<&'a LargeBody>,
    /// For whole-object fits.
    pub whole: Option<&'a WholeBody<'a>>,
}

/// Fits one objective on every cell and assembles the network; `reference` is needed by sampled and whole-object fits.
///
/// # Errors
/// A spring group is no group of the elements, a law does not go with the groups, or there is nothing to sample.
pub fn fit_mesh(
    mesh: &Mesh,
    material: Material,
    reference: &Reference,
    named: &NamedFit,
    progress: &mut Progress,
) -> Result<FitOutcome> {
    let moduli = material.moduli();
    // Threads start before the clock does.
    rayon::broadcast(|_| ());
    let start = Instant::now();
    let mut sampled: Option<SampledOutcome> = None;
    let mut unmet = None;
    let mut fits = match (&named.recipe, named.recipe.at_rest(), named.recipe.sampled()) {
        (&Recipe::Published(method), ..) => {
            let of_method = |e: Error| e.placed(|e| Error::at("objective", e.to_string()));
            for block in &mesh.blocks {
                let named = named.springs.iter().flat_map(|springs| block.element.select_groups(Some(springs)));
                if let Some(group) = named.flatten().find(|group| group.kind != SpringKind::Length) {
                    let expected = format!("groups of length springs, beside which {} adds its own", method.name());
                    return Err(Error::expected("springs", expected, format!("\"{}\"", group.name)));
                }
                let own = published::unmet(method, &block.element, &mesh.points, &block.connectivity, material);
                unmet = Some(unmet.unwrap_or(Unmet::default()).and(own.map_err(of_method)?));
            }
            each_block(mesh, named, progress, |block, springs, _| {
                published::fit(method, &block.element, springs, &mesh.points, &block.connectivity, material)
                    .map_err(of_method)
            })?
        }
        (_, _, Some(recipe)) => {
            let own = recipe.law.as_ref().map(|law| Energy::load(law, material)).transpose();
            let own = own.map_err(|e| e.placed(|e| Error::at("law", e.problem())))?;
            let own = own.map(|energy| LargeBody::at_rest(energy, material.state()));
            let expected = "the energy whose forces are sampled";
            let large = own.as_ref().or(reference.large).ok_or_else(|| Error::expected("law", expected, "none"))?;
            let states = Arc::new(large.states(mesh, &recipe.loads)?);
            let mut known = Vec::new();
            for block in &mesh.blocks {
                let used = block.element.select_groups(named.springs.as_deref())?;
                known.extend(used.iter().map(|group| group.name.as_str()));
            }
            recipe.force.check_groups(&known)?;
            let found = each_block(mesh, named, progress, |block, springs, progress| {
                let fit = recipe.resolve(&block.element, springs, &states)?;
                let (points, cells) = (&mesh.points, &block.connectivity);
                fit_sampled(&block.element, springs, points, cells, &large.energy, material.state(), &fit, progress)
            })?;
            sampled = Some(SampledOutcome::of(recipe, &found));
            found.into_iter().map(|found| found.fits).collect()
        }
        (_, Some(fit), None) => each_block(mesh, named, progress, |block, springs, progress| {
            fit_cells(&block.element, springs, &mesh.points, &block.connectivity, moduli, &fit, progress)
        })?,
        (_, None, None) => unreachable!("a recipe is a formula, or is or starts from one of both"),
    };
    let seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    if matches!(&named.recipe, Recipe::Whole(_)) {
        raise_idle(&mut fits);
    }
    let mut network = Network::assemble(mesh, &fits);
    let seconds_assembly = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let mut whole = None;
    if let Recipe::Whole(recipe) = &named.recipe {
        let missing = || Error::at("objective", "\"whole\" belongs to a scene with supports");
        let body = reference.whole.ok_or_else(missing)?;
        let (found, outcome) = body.fit(named, recipe, &fits, &network, progress)?;
        (network, whole) = (found, Some(outcome));
        // What is known of the start is not so of what came of it.
        sampled = None;
        for fit in &mut fits {
            (fit.deficient, fit.unreached, fit.reused) = (0, 0, 0);
            fit.certificates.clear();
        }
    }
    let seconds = seconds + start.elapsed().as_secs_f64();
    let mut errors = ElementErrors::default();
    for (block, fit) in mesh.blocks.iter().zip(&fits).filter(|_| whole.is_none()) {
        errors.extend(element_errors(&block.element, &mesh.points, &block.connectivity, moduli, fit)?);
    }
    let certificates = || fits.iter().flat_map(|f| &f.certificates);
    let largest = certificates().map(|c| c.value).reduce(f64::max);
    let relative =
        matches!(&named.recipe, Recipe::Stiffness(fit) if fit.objective == Objective::Spectral(Weight::Relative));
    let spread = |values: &[f64]| whole.is_none().then(|| Spread::of(values));
    Ok(FitOutcome {
        fit: named.clone(),
        network,
        seconds,
        seconds_assembly,
        deficient: fits.iter().map(|f| f.deficient).sum(),
        unreached: fits.iter().map(|f| f.unreached).sum(),
        reused: fits.iter().map(|f| f.reused).sum(),
        ambiguous: certificates().filter(|c| c.ambiguous).count(),
        gap: certificates().map(|c| c.gap()).reduce(f64::max),
        energy_error: largest.filter(|epsilon| relative && *epsilon < 1.0),
        frobenius: spread(&errors.frobenius),
        spectral: spread(&errors.spectral),
        whole,
        moduli: None,
        unmet,
        sampled,
        stability: None,
        loose_points: Vec::new(),
        loads: Vec::new(),
    })
}

/// `fit` of every block with its springs; the progress it tells is that of all cells.
fn each_block<T>(
    mesh: &Mesh,
    named: &NamedFit,
    progress: &mut Progress,
    fit: impl Fn(&CellBlock, &Springs, &mut dyn FnMut(usize)) -> Result<T>,
) -> Result<Vec<T>> {
    let total = mesh.cell_count();
    let mut done = 0;
    let mut all = Vec::new();
    for block in &mesh.blocks {
        let springs = Springs::select(&block.element, named.springs.as_deref())?;
        all.push(fit(block, &springs, &mut |n| progress(&named.name, done + n, total))?);
        done += block.cells().len();
    }
    Ok(all)
}

impl SampledOutcome {
    fn of(recipe: &SampledRecipe, found: &[SampledFits]) -> SampledOutcome {
        let spread =
            |of: fn(&SampledFits) -> &Vec<f64>| Spread::of(&found.iter().flat_map(of).copied().collect::<Vec<f64>>());
        let apart = found.iter().flat_map(|f| &f.held_out).all(|error| error.is_finite());
        let held_out = apart.then(|| spread(|f| &f.held_out));
        SampledOutcome {
            shapes: recipe.fit.sampling.shapes,
            trained: spread(|f| &f.trained),
            held_out,
            agreeing: found.iter().filter_map(|f| f.agreeing).reduce(f64::min),
            loads: recipe.loads.clone(),
        }
    }
}
