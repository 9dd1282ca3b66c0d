//! Runs a scene: fit each objective, solve each load with both models, compare.

use super::cases::load_cases;
use super::large::LargeBody;
use super::linear::LinearBody;
use super::moduli::moduli_of_body;
use super::outcome::{FitOutcome, Outcome, SampledOutcome};
use super::scene::{NamedFit, Recipe, SampledRecipe, Scene};
use super::stages::stages;
use crate::element::SpringGroup;
use crate::error::{Error, Result};
use crate::fit::{ElementErrors, Objective, SampledFits, Spread, Weight, element_errors, fit_cells, fit_sampled};
use crate::material::Material;
use crate::mesh::{CellBlock, Mesh};
use crate::model::{Network, masses};
use crate::springs::Springs;
use std::sync::Arc;
use std::time::Instant;

/// Told the stage, the steps done and the steps in all.
pub type Progress<'a> = dyn FnMut(&str, usize, usize) + 'a;

/// Runs the scene. Work is done only for what the scene names.
///
/// # Errors
/// An input is wrong: a group, a support, a load, the mesh. A network that does not stand is no error.
pub fn run(scene: &Scene, progress: &mut Progress) -> Result<Outcome> {
    let mesh = scene.build_mesh()?;
    let material = scene.material(mesh.cell_dimension())?;
    drawable(scene, &mesh)?;
    let cases = load_cases(scene, &mesh, material)?;
    let in_scene = |e: Error| e.placed(|e| e.in_file(&scene.path));
    let large = match scene.energy(material)? {
        Some(energy) => {
            let state = material.state();
            Some(LargeBody::solve(&mesh, state, energy, scene.newton, &cases, progress).map_err(in_scene)?)
        }
        None => None,
    };
    let mut outcome = Outcome {
        scene: scene.title.clone(),
        material,
        masses: scene.density().map(|density| masses(&mesh, density, material.thickness())),
        fem: Vec::new(),
        law: large.as_ref().map(|large| large.energy.title.clone()),
        followed: Vec::new(),
        fits: Vec::new(),
        left_out: stages(scene).into_iter().filter_map(|(what, why)| Some(format!("{what}: {}", why?))).collect(),
        mesh,
    };
    for (i, fit) in scene.fits.iter().enumerate() {
        let fitted = fit_mesh(&outcome.mesh, material, large.as_ref(), fit, progress);
        outcome.fits.push(fitted.map_err(|e| scene.at(&format!("fit[{i}]"), e))?);
    }
    if scene.output.moduli {
        for (done, fit) in outcome.fits.iter_mut().enumerate() {
            progress("moduli", done, scene.fits.len());
            fit.moduli = moduli_of_body(&outcome.mesh, &fit.network.stiffness(&outcome.mesh.points))?;
        }
    }
    if let Some(large) = large {
        for (done, fit) in outcome.fits.iter_mut().enumerate() {
            progress("networks", done, scene.fits.len());
            large.compare(&outcome.mesh, &cases, fit)?;
        }
        (outcome.fem, outcome.followed) = (large.displacements, large.followed);
        return Ok(outcome);
    }
    let body = LinearBody::solve(&outcome.mesh, material.moduli(), &cases, progress).map_err(in_scene)?;
    for fit in &mut outcome.fits {
        progress("networks", outcome.fem.len(), cases.len());
        body.compare(&outcome.mesh, &cases, fit)?;
    }
    outcome.fem = body.displacements;
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

/// Fits one objective on every cell and assembles the network. A sampled fit needs the forces of `large`.
///
/// # Errors
/// A spring group is no group of the elements, a law does not go with the groups, or there is nothing to sample.
pub fn fit_mesh(
    mesh: &Mesh,
    material: Material,
    large: Option<&LargeBody>,
    named: &NamedFit,
    progress: &mut Progress,
) -> Result<FitOutcome> {
    let moduli = material.moduli();
    // Threads start before the clock does.
    rayon::broadcast(|_| ());
    let start = Instant::now();
    let mut sampled: Option<SampledOutcome> = None;
    let fits = match &named.recipe {
        Recipe::Stiffness(fit) => each_block(mesh, named, progress, |block, springs, progress| {
            fit_cells(&block.element, springs, &mesh.points, &block.connectivity, moduli, fit, progress)
        })?,
        Recipe::Forces(recipe) => {
            let expected = "the energy whose forces are sampled";
            let large = large.ok_or_else(|| Error::expected("law", expected, "none"))?;
            let states = Arc::new(large.states(&recipe.loads)?);
            let groups = mesh.blocks.iter().flat_map(|block| &block.element.springs);
            let used = |group: &&SpringGroup| match &named.springs {
                Some(names) => names.contains(&group.name),
                None => !group.optional,
            };
            recipe.force.check_groups(&groups.filter(used).map(|group| group.name.as_str()).collect::<Vec<_>>())?;
            let found = each_block(mesh, named, progress, |block, springs, progress| {
                let fit = recipe.resolve(&block.element, springs, &states)?;
                let (points, cells) = (&mesh.points, &block.connectivity);
                fit_sampled(&block.element, springs, points, cells, &large.energy, material.state(), &fit, progress)
            })?;
            sampled = Some(SampledOutcome::of(recipe, &found));
            found.into_iter().map(|found| found.fits).collect()
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let network = Network::assemble(mesh, &fits);
    let seconds_assembly = start.elapsed().as_secs_f64();
    let mut errors = ElementErrors::default();
    for (block, fit) in mesh.blocks.iter().zip(&fits) {
        errors.extend(element_errors(&block.element, &mesh.points, &block.connectivity, moduli, fit)?);
    }
    let certificates = || fits.iter().flat_map(|f| &f.certificates);
    let largest = certificates().map(|c| c.value).reduce(f64::max);
    let relative =
        matches!(&named.recipe, Recipe::Stiffness(fit) if fit.objective == Objective::Spectral(Weight::Relative));
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
        frobenius: Spread::of(&errors.frobenius),
        spectral: Spread::of(&errors.spectral),
        moduli: None,
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
